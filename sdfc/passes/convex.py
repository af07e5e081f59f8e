"""Convex polygons in the plane, by their corners and by their sides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]
MOST_SIDES = 64  # a ray meets the planes one by one: with more of them the distance in the plane is no dearer
_FLAT = 1e-9  # radians: a corner that turns by less is none


@dataclass(frozen=True, slots=True)
class Side:
    """The points on the inner side: x X + y Y <= offset, with (x, y) a unit vector."""

    x: float
    y: float
    offset: float


def span_of(points: Sequence[Point]) -> tuple[Point, Point]:
    """The lower and the upper corner of the rectangle around."""
    xs, ys = zip(*points, strict=True)
    return (min(xs), min(ys)), (max(xs), max(ys))


def convex_sides(points: Sequence[Point]) -> list[Side]:
    """The sides of a convex polygon, in the order of its corners, without those that go on straight from the last. None
    where the polygon is not convex, or has too many."""
    distinct = [p for i, p in enumerate(points) if p != points[i - 1]]
    if len(distinct) < 3 or not all(math.isfinite(v) for p in distinct for v in p):
        return []
    turns = [_turn(distinct[i - 1], p, distinct[(i + 1) % len(distinct)]) for i, p in enumerate(distinct)]
    corners = [p for p, turn in zip(distinct, turns, strict=True) if abs(turn) > _FLAT]
    direction = math.copysign(1.0, math.fsum(turns))
    if abs(abs(math.fsum(turns)) - math.tau) > 1e-6 or any(direction * turn < -_FLAT for turn in turns):
        return []
    if not 3 <= len(corners) <= MOST_SIDES or max(map(abs, turns)) > math.pi - 1e-6:
        return []
    return [_side(corners[i - 1], corner, direction) for i, corner in enumerate(corners)]


def _turn(a: Point, b: Point, c: Point) -> float:
    """The angle by which the way from a over b to c turns left."""
    before, after = (b[0] - a[0], b[1] - a[1]), (c[0] - b[0], c[1] - b[1])
    cross = before[0] * after[1] - before[1] * after[0]
    return math.atan2(cross, before[0] * after[0] + before[1] * after[1])


def _side(a: Point, b: Point, direction: float) -> Side:
    length = math.dist(a, b)
    x, y = direction * (b[1] - a[1]) / length, direction * (a[0] - b[0]) / length
    return Side(x, y, max(x * a[0] + y * a[1], x * b[0] + y * b[1]))
