"""Closed lines in the plane: orientation, convexity, hull, mitred offset, and convex pieces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sdfc.openscad.refusal import RefusalError

Point2: TypeAlias = tuple[float, float]
Edge: TypeAlias = tuple[Point2, float]  # unit normal n (out of the region) and offset d: inside where n . p <= d

STRAIGHT = 1e-9  # a turn below this part of the lengths involved is no corner


def regular(count: int, radius: float) -> tuple[Point2, ...]:
    """OpenSCAD's circle of `count` pieces: the first corner is at angle 0."""
    return tuple((radius * math.cos(a), radius * math.sin(a)) for a in (math.tau * i / count for i in range(count)))


@dataclass(frozen=True, slots=True)
class Regular:
    """A regular polygon: `phase` is the angle of its first corner (radians)."""

    center: Point2
    radius: float
    phase: float
    count: int


def regular_form(points: Sequence[Point2]) -> Regular | None:
    """These points as a regular polygon, to the six digits of a .csg file; None where they are not one."""
    count = len(points)
    x, y = (math.fsum(p[axis] for p in points) / count for axis in (0, 1))
    first = (points[0][0] - x, points[0][1] - y)
    radius, phase = math.hypot(*first), math.atan2(first[1], first[0])
    step = math.copysign(math.tau / count, area(points))
    for i, p in enumerate(points):
        angle = phase + step * i
        if math.dist(p, (x + radius * math.cos(angle), y + radius * math.sin(angle))) > 1e-5 * radius:
            return None
    return Regular((x, y), radius, phase, count)


def area(points: Sequence[Point2]) -> float:
    """Signed: positive counter-clockwise."""
    shifted = [*points[1:], points[0]]
    return 0.5 * math.fsum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, shifted, strict=True))


def cleaned(points: Sequence[Point2]) -> tuple[Point2, ...]:
    """Without repeated corners; empty where no area can be within."""
    kept = [p for i, p in enumerate(points) if p != points[i - 1]]
    if len(kept) < 3 or len(hull(kept)) < 3:
        return ()
    return tuple(kept)


def _turn(a: Point2, b: Point2, c: Point2) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _bend(a: Point2, b: Point2, c: Point2) -> int:
    """1 for a left turn at b, -1 for a right one, 0 for none to speak of."""
    turn = _turn(a, b, c)
    return 0 if abs(turn) <= STRAIGHT * math.dist(a, b) * math.dist(b, c) else (1 if turn > 0 else -1)


def hull(points: Sequence[Point2]) -> tuple[Point2, ...]:
    """The convex hull, counter-clockwise, corners only (Andrew's monotone chain, 1979)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return tuple(ordered)
    halves: list[list[Point2]] = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[Point2] = []
        for p in sequence:
            while len(chain) >= 2 and _bend(chain[-2], chain[-1], p) <= 0:
                chain.pop()
            chain.append(p)
        halves.append(chain[:-1])
    return tuple(halves[0] + halves[1])


def is_convex(points: Sequence[Point2]) -> bool:
    """Turns to one side only, and once around."""
    n = len(points)
    bends = {_bend(points[i - 1], points[i], points[(i + 1) % n]) for i in range(n)} - {0}
    if len(bends) != 1:
        return False
    total = math.fsum(_angle(points[i - 1], points[i], points[(i + 1) % n]) for i in range(n))
    return abs(abs(total) - math.tau) < 1e-3


def _angle(a: Point2, b: Point2, c: Point2) -> float:
    dot = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])
    return math.atan2(_turn(a, b, c), dot)


def edges(points: Sequence[Point2]) -> list[Edge]:
    """The half-planes of a convex region's sides."""
    ordered = points if area(points) > 0.0 else tuple(reversed(points))
    return [_half_plane(ordered[i - 1], ordered[i]) for i in range(len(ordered))]


def _half_plane(a: Point2, b: Point2) -> Edge:
    length = math.dist(a, b)
    normal = ((b[1] - a[1]) / length, (a[0] - b[0]) / length)
    return normal, normal[0] * a[0] + normal[1] * a[1]


def is_simple(points: Sequence[Point2]) -> bool:
    """Whether no two sides cross or touch, other than neighbours at their corner."""
    n = len(points)
    sides = [(points[i], points[(i + 1) % n]) for i in range(n)]
    for i in range(n):
        for j in range(i + 2, n):
            if (i, j) != (0, n - 1) and meet(*sides[i], *sides[j]):
                return False
    return all(_bend(points[i - 1], points[i], points[(i + 1) % n]) or not _turns_back(points, i) for i in range(n))


def _turns_back(points: Sequence[Point2], i: int) -> bool:
    a, b, c = points[i - 1], points[i], points[(i + 1) % len(points)]
    return (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0


def meet(a: Point2, b: Point2, c: Point2, d: Point2) -> bool:
    """Whether two line segments have a point in common."""
    if max(a[0], b[0]) < min(c[0], d[0]) or max(c[0], d[0]) < min(a[0], b[0]):
        return False
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    return _turn(a, b, c) * _turn(a, b, d) <= 0.0 and _turn(c, d, a) * _turn(c, d, b) <= 0.0


def contains(points: Sequence[Point2], p: Point2) -> bool:
    """By the even-odd rule."""
    inside = False
    for i, (bx, by) in enumerate(points):
        ax, ay = points[i - 1]
        if (ay > p[1]) != (by > p[1]) and p[0] < ax + (p[1] - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def mitred(points: Sequence[Point2], amount: float) -> tuple[Point2, ...]:
    """Every side moved out by `amount`, corners kept sharp. Refuses where sides would vanish or collide."""
    ordered = tuple(points) if area(points) > 0.0 else tuple(reversed(points))
    n = len(ordered)
    corners = [p for i, p in enumerate(ordered) if _bend(ordered[i - 1], p, ordered[(i + 1) % n])]
    sides = edges(corners)  # sides[i] ends at corner i
    n = len(corners)
    made = []
    for i in range(n):
        ((a, b), d), ((e, f), g) = sides[i], sides[(i + 1) % n]
        d, g, scale = d + amount, g + amount, a * f - b * e
        made.append(((d * f - b * g) / scale, (a * g - d * e) / scale))
    kept = all(
        (made[i][0] - made[i - 1][0]) * (corners[i][0] - corners[i - 1][0])
        + (made[i][1] - made[i - 1][1]) * (corners[i][1] - corners[i - 1][1])
        > 0.0
        for i in range(n)
    )
    if not kept or not is_simple(made):
        raise RefusalError("the sides of this shape collide as they are offset", "no exact form is known here for that")
    return tuple(made)


def shrunk(points: Sequence[Point2], amount: float) -> tuple[Point2, ...]:
    """What of a convex polygon is `amount` or farther inside; empty for nothing (Sutherland and Hodgman, 1974)."""
    kept: list[Point2] = list(points)
    for (a, b), offset in edges(cleaned(points)):
        level = offset - amount
        above = [a * x + b * y - level for x, y in kept]
        cut: list[Point2] = []
        for i, q in enumerate(kept):
            p, f, g = kept[i - 1], above[i - 1], above[i]
            if (f > 0.0) != (g > 0.0):
                t = f / (f - g)
                cut.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
            if g <= 0.0:
                cut.append(q)
        kept = cut
    return hull(kept) if len(kept) >= 3 and len(hull(kept)) >= 3 else ()


@dataclass(frozen=True, slots=True, eq=False)
class Pocketed:
    """A convex region (some of its sides left out) without its pockets."""

    sides: tuple[Edge, ...]
    pockets: tuple[Pocketed, ...]

    @property
    def pieces(self) -> int:
        return 1 + sum(p.pieces for p in self.pockets)


def pocketed(points: Sequence[Point2]) -> Pocketed:
    """A simple polygon as its hull without pockets, these again as hulls without pockets, and so on.

    Where a pocket opens, its side is left out: the region around bounds it there, and no surface may remain between.
    """
    ordered = tuple(points) if area(points) > 0.0 else tuple(reversed(points))
    return _pocketed(ordered, is_open=False, depth=0)


def _pocketed(points: tuple[Point2, ...], is_open: bool, depth: int) -> Pocketed:
    """`points` counter-clockwise; if open, the side from the last to the first corner is left out."""
    if depth > 100:
        raise RefusalError("this polygon winds too much")
    corners = hull(points)
    place = {p: i for i, p in enumerate(points)}
    around = sorted(place[p] for p in corners)
    sides, pockets = [], []
    n = len(points)
    for k, i in enumerate(around):
        j = around[(k + 1) % len(around)]
        if not (is_open and i == n - 1 and j == 0):
            sides.append(_half_plane(points[i], points[j]))
        count = (j - i) % n
        between = tuple(points[(i + m) % n] for m in range(count, -1, -1))  # reversed: a pocket is outside
        if count > 1 and len(cleaned(between)) >= 3:
            pockets.append(_pocketed(between, is_open=True, depth=depth + 1))
    return Pocketed(tuple(sides), tuple(pockets))
