"""Shapes in the plane, kept as geometry until they are extruded or revolved: what is exact depends on which it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias, TypeVar, assert_never

from sdfc.openscad import outline
from sdfc.openscad.outline import Point2
from sdfc.openscad.refusal import RefusalError

Map2: TypeAlias = tuple[tuple[float, float, float], tuple[float, float, float]]  # rows: linear part, offset
T = TypeVar("T")

SIMILAR = 1e-4  # relative: the matrices of a .csg file have six digits


@dataclass(frozen=True, slots=True, eq=False)
class Polygon:
    """What is within one closed line, by the even-odd rule. Three corners or more, no two in succession equal."""

    points: tuple[Point2, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Disc:
    """The image of the unit disc."""

    map: Map2

    @property
    def center(self) -> Point2:
        return self.map[0][2], self.map[1][2]

    @property
    def radius(self) -> float | None:
        """None where it is an ellipse."""
        return similarity(self.map)


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """All points within `radius` of a closed line."""

    points: tuple[Point2, ...]
    radius: float


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    children: tuple[Plane, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Common:
    children: tuple[Plane, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Outside:
    """The complement; only ever a child of Common."""

    child: Plane


Leaf: TypeAlias = Polygon | Disc | Stroke
Plane: TypeAlias = Leaf | Joined | Common | Outside


def children_of(plane: Plane) -> tuple[Plane, ...]:
    match plane:
        case Polygon() | Disc() | Stroke():
            return ()
        case Outside():
            return (plane.child,)
        case Joined() | Common():
            return plane.children
        case _:
            assert_never(plane)


def fold(root: Plane, combine: Callable[[Plane, int, list[T]], T]) -> T:
    """`combine(node, number of complements above it, results of its children)`, children first. Iterative."""
    results: dict[tuple[int, int], T] = {}
    stack: list[tuple[Plane, int, bool]] = [(root, 0, False)]
    while stack:
        node, level, expanded = stack.pop()
        below = level + 1 if isinstance(node, Outside) else level
        if (id(node), level) in results:
            continue
        if expanded:
            results[id(node), level] = combine(node, level, [results[id(c), below] for c in children_of(node)])
        else:
            stack.append((node, level, True))
            stack.extend((c, below, False) for c in reversed(children_of(node)))
    return results[id(root), 0]


def joined(parts: Iterable[Plane]) -> Plane:
    """The union of one part or more."""
    children = tuple(parts)
    return children[0] if len(children) == 1 else Joined(children)


def without(first: Plane, rest: Iterable[Plane]) -> Plane:
    return Common((first, *(Outside(r) for r in rest)))


def circle(radius: float, center: Point2 = (0.0, 0.0)) -> Disc:
    return Disc(((radius, 0.0, center[0]), (0.0, radius, center[1])))


def determinant(move: Map2) -> float:
    (a, b, _), (c, d, _) = move
    return a * d - b * c


def similarity(move: Map2) -> float | None:
    """The factor of a map that keeps angles; None for any other."""
    (a, b, _), (c, d, _) = move
    factor = math.sqrt(abs(a * d - b * c))
    skew = max(abs(math.hypot(a, c) - factor), abs(math.hypot(b, d) - factor), abs(a * b + c * d) / max(factor, 1e-300))
    return factor if skew <= SIMILAR * factor else None


def moved_point(move: Map2, p: Point2) -> Point2:
    (a, b, x), (c, d, y) = move
    return a * p[0] + b * p[1] + x, c * p[0] + d * p[1] + y


def after(second: Map2, first: Map2) -> Map2:
    """The map that does `first`, then `second`."""
    x, y = moved_point(second, (first[0][2], first[1][2]))
    (a, b, _), (c, d, _) = second
    (e, f, _), (g, h, _) = first
    return (a * e + b * g, a * f + b * h, x), (c * e + d * g, c * f + d * h, y)


def moved(root: Plane, move: Map2) -> Plane:
    """The image under an affine map that is not singular."""

    def image(node: Plane, _: int, parts: list[Plane]) -> Plane:
        match node:
            case Polygon():
                return Polygon(tuple(moved_point(move, p) for p in node.points))
            case Disc():
                return Disc(after(move, node.map))
            case Stroke():
                factor = similarity(move)
                if factor is None:
                    raise RefusalError(
                        "an offset shape can only be scaled alike in x and y", "scale it before `offset`"
                    )
                return Stroke(tuple(moved_point(move, p) for p in node.points), node.radius * factor)
            case Joined():
                return Joined(tuple(parts))
            case Common():
                return Common(tuple(parts))
            case Outside():
                return Outside(parts[0])
            case _:
                assert_never(node)

    return fold(root, image)


def grown(root: Plane, amount: float) -> Plane | None:
    """`offset(r = amount)`: all points within `amount`, or what is farther inside than `-amount`; None for nothing.

    Growing goes into a union, and shrinking into an intersection; the other way round corners would be wrong.
    """

    def image(node: Plane, level: int, parts: list[Plane | None]) -> Plane | None:
        by = -amount if level % 2 else amount
        match node:
            case Polygon():
                return _grown_polygon(node, by)
            case Disc():
                if node.radius is None:
                    raise RefusalError("the offset of an ellipse has no exact form")
                return circle(node.radius + by, node.center) if node.radius + by > 0.0 else None
            case Stroke():
                return Stroke(node.points, node.radius + by) if node.radius + by > 0.0 else None
            case Joined() if by > 0.0:
                kept = [p for p in parts if p is not None]
                return joined(kept) if kept else None
            case Common() if by < 0.0:
                gone = [c for c, p in zip(node.children, parts, strict=True) if p is None]
                if not all(isinstance(c, Outside) for c in gone):
                    return None
                return Common(tuple(p for p in parts if p is not None))
            case Joined() | Common():
                raise RefusalError(
                    "the offset of this has no exact form",
                    "a union can grow, and a difference or an intersection can shrink",
                )
            case Outside():
                return Outside(parts[0]) if parts[0] is not None else None
            case _:
                assert_never(node)

    return fold(root, image) if amount else root


def _grown_polygon(polygon: Polygon, amount: float) -> Plane | None:
    points = polygon.points
    if outline.is_convex(points) and amount < 0.0:
        shrunk = outline.shrunk(points, -amount)
        return Polygon(shrunk) if shrunk else None
    if outline.is_convex(points):
        return hull_of_discs([(p, amount) for p in points])
    wall = Stroke(points, abs(amount))
    return Joined((polygon, wall)) if amount > 0.0 else Common((polygon, Outside(wall)))


def mitred(root: Plane, amount: float) -> Plane | None:
    """`offset(delta = amount)`: polygons with sharp corners, and discs. Refuses for what is not one of these."""
    match root:
        case Polygon():
            if outline.is_convex(root.points) and amount < 0.0:
                made = outline.shrunk(root.points, -amount)
            elif outline.is_simple(root.points):
                made = outline.mitred(root.points, amount)
            else:
                raise RefusalError("a polygon that crosses itself cannot be offset")
            return Polygon(made) if made else None
        case Disc() if root.radius is not None:
            return circle(root.radius + amount, root.center) if root.radius + amount > 0.0 else None
        case _:
            raise RefusalError("the offset by `delta` of this has no exact form", "one polygon or circle has")


def hull_of_discs(discs: list[tuple[Point2, float]]) -> Plane | None:
    """The convex hull of discs and points (radius 0): the polygon through the points of tangency, and the discs."""
    touched: list[Point2] = []
    outer: list[Disc] = []
    kept = _not_within(discs)
    for i, (center, radius) in enumerate(kept):
        tangency = [t for j, other in enumerate(kept) if i != j for t in _tangency(i, j, kept)] if radius else [center]
        touched.extend(tangency)
        if radius and (tangency or len(kept) == 1):
            outer.append(circle(radius, center))
    corners = outline.hull(touched)
    parts: list[Plane] = [Polygon(corners)] if len(corners) >= 3 else []
    parts.extend(outer)
    return joined(parts) if parts else None


def _not_within(discs: list[tuple[Point2, float]]) -> list[tuple[Point2, float]]:
    """Without those that lie within another."""
    kept: list[tuple[Point2, float]] = []
    for center, radius in sorted(set(discs), key=lambda d: -d[1]):
        if all(math.dist(center, c) + radius > r * (1.0 + 1e-12) for c, r in kept if r > 0.0):
            kept.append((center, radius))
    return kept


def _tangency(i: int, j: int, discs: list[tuple[Point2, float]]) -> list[Point2]:
    """Where the lines that touch discs i and j, and have all others on one side, touch disc i."""
    (a, r), (b, s) = discs[i], discs[j]
    length = math.dist(a, b)
    u = ((a[0] - b[0]) / length, (a[1] - b[1]) / length)
    along = (s - r) / length
    across = math.sqrt(max(1.0 - along * along, 0.0))
    found = []
    for side in (across, -across):
        n = (along * u[0] - side * u[1], along * u[1] + side * u[0])
        level = n[0] * a[0] + n[1] * a[1] + r
        slack = 1e-9 * (length + r + s)
        if all(n[0] * c[0] + n[1] * c[1] + q <= level + slack for c, q in discs):
            found.append((a[0] + r * n[0], a[1] + r * n[1]))
    return found


def extent(root: Plane) -> tuple[Point2, Point2] | None:
    """A box around it (tight for polygons and discs, and unions of them); None where nothing bounds it."""

    def box(node: Plane, _: int, parts: list[tuple[Point2, Point2] | None]) -> tuple[Point2, Point2] | None:
        match node:
            case Polygon():
                xs, ys = zip(*node.points, strict=True)
                return (min(xs), min(ys)), (max(xs), max(ys))
            case Disc():
                (a, b, x), (c, d, y) = node.map
                w, h = math.hypot(a, b), math.hypot(c, d)
                return (x - w, y - h), (x + w, y + h)
            case Stroke():
                xs, ys = zip(*node.points, strict=True)
                r = node.radius
                return (min(xs) - r, min(ys) - r), (max(xs) + r, max(ys) + r)
            case Joined() | Common():
                boxes = [b for b in parts if b is not None]
                outer, inner = (min, max) if isinstance(node, Joined) else (max, min)
                lo = outer(b[0][0] for b in boxes), outer(b[0][1] for b in boxes)
                hi = inner(b[1][0] for b in boxes), inner(b[1][1] for b in boxes)
                return lo, hi
            case Outside():
                return None
            case _:
                assert_never(node)

    return fold(root, box)


def farthest(root: Plane) -> float:
    """How far from the origin its polygons and discs go, those that are taken away too."""

    def reach(node: Plane, _: int, parts: list[float]) -> float:
        box = extent(node) if not parts else None
        return (
            max(parts)
            if box is None
            else max(math.hypot(x, y) for x in (box[0][0], box[1][0]) for y in (box[0][1], box[1][1]))
        )

    return fold(root, reach)


def is_tight(root: Plane) -> bool:
    """Whether `extent` is the smallest box."""
    return fold(root, lambda node, _, parts: all(parts) and not isinstance(node, Common | Outside))


def spanning_discs(root: Plane) -> list[tuple[Point2, float]]:
    """Points (radius 0) and discs whose convex hull is that of the shape. Refuses where that is not known."""

    def discs(node: Plane, _: int, parts: list[list[tuple[Point2, float]]]) -> list[tuple[Point2, float]]:
        match node:
            case Polygon():
                return [(p, 0.0) for p in node.points]
            case Disc():
                if node.radius is None:
                    raise RefusalError("the hull of an ellipse has no exact form")
                return [(node.center, node.radius)]
            case Stroke():
                return [(p, node.radius) for p in node.points]
            case Joined():
                return [d for part in parts for d in part]
            case Common() | Outside():
                raise RefusalError("the hull of a difference or an intersection has no exact form")
            case _:
                assert_never(node)

    return fold(root, discs)
