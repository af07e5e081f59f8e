"""Points and affine maps in space, as numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

Point: TypeAlias = tuple[float, float, float]
Map3: TypeAlias = Sequence[Sequence[float]]  # three rows of four: linear part, offset

IDENTITY: Map3 = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))
SIMILAR = 1e-4  # relative: the matrices of a .csg file have six digits


def translation(p: Sequence[float]) -> Map3:
    return ((1.0, 0.0, 0.0, p[0]), (0.0, 1.0, 0.0, p[1]), (0.0, 0.0, 1.0, p[2]))


def after(second: Map3, first: Map3) -> Map3:
    """The map that does `first`, then `second`."""
    return tuple(
        tuple(
            row[0] * first[0][j] + row[1] * first[1][j] + row[2] * first[2][j] + (row[3] if j == 3 else 0.0)
            for j in range(4)
        )
        for row in second
    )


def inverse(move: Map3) -> Map3:
    """By the adjugate; infinite where the map is singular or nearly."""
    a, b, c = ((row[0], row[1], row[2]) for row in move)
    columns = (cross(b, c), cross(c, a), cross(a, b))
    determinant = dot(a, columns[0])
    if not abs(determinant) > 1e-300:
        return ((math.inf,) * 4,) * 3
    linear = [[column[i] / determinant for column in columns] for i in range(3)]
    return tuple((*row, -(row[0] * move[0][3] + row[1] * move[1][3] + row[2] * move[2][3])) for row in linear)


def moved_point(move: Map3, p: Point) -> Point:
    x, y, z = (r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3] for r in move)
    return x, y, z


def direction(move: Map3, p: Point) -> Point:
    x, y, z = (r[0] * p[0] + r[1] * p[1] + r[2] * p[2] for r in move)
    return x, y, z


def similarity(move: Map3) -> float | None:
    """The factor of a map that keeps angles; None for any other."""
    columns = [(move[0][j], move[1][j], move[2][j]) for j in range(3)]
    factor = abs(dot(columns[0], cross(columns[1], columns[2]))) ** (1.0 / 3.0)
    skew = [abs(norm(c) - factor) * factor for c in columns]
    skew += [abs(dot(columns[i], columns[(i + 1) % 3])) for i in range(3)]
    return factor if max(skew) <= SIMILAR * factor * factor else None


def frame(axis: Point) -> tuple[Point, Point]:
    """Two unit vectors that make a right-handed frame with a unit axis."""
    helper = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.6 else (0.0, 1.0, 0.0)
    u = cross(helper, axis)
    size = norm(u)
    u = (u[0] / size, u[1] / size, u[2] / size)
    return u, cross(axis, u)


def cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: Point) -> float:
    return math.hypot(*a)
