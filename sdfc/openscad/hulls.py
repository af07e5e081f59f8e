"""`hull` and `minkowski` where they are exact: polytopes, balls and points, round and straight towers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import pairwise

from sdfc.openscad import outline, plane, polytope, rounded
from sdfc.openscad.generators import Generator, Spanned, generators
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.lathe import Lathe
from sdfc.openscad.outline import Point2
from sdfc.openscad.part import Flat, Part, Solid
from sdfc.openscad.plane import Disc, Joined, Plane, Polygon
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.solids import points_hull
from sdfc.openscad.space import Point, frame, moved_point
from sdfc.openscad.tower import Tower
from sdfc.shape.graph import Shape

NEAR = 1e-5  # of the extent: a .csg file has six digits
MOST_SUMS = 200_000
MOST_FACES = 96  # of a hull of balls or cylinders of few pieces; one with more is shown with true curves
GENERAL = "`hull` is exact here for points and balls, for discs in two parallel planes, and for discs around one axis"


def hull(m: Invocation) -> Part | None:
    """The convex hull of all children."""
    parts = m.parts()
    if not parts:
        return None
    if len(parts) == 1 and parts[0].is_convex:
        return parts[0]
    flats = [p.plane for p in parts if isinstance(p, Flat)]
    if flats:
        return _flat_hull([d for f in flats for d in plane.spanning_discs(f)])
    return _spanned(
        m, lambda as_curves: [g for p in parts if isinstance(p, Solid) for g in generators(p.hull, as_curves)]
    )


def _flat_hull(discs: list[tuple[Point2, float]]) -> Flat | None:
    made = plane.hull_of_discs(discs)
    return None if made is None else Flat(made, is_convex=True)


def _spanned(m: Invocation, spans: Callable[[bool], list[Generator]]) -> Solid | None:
    """The hull of `spans(as_curves)`: with the pieces that the file asks for, unless these make too many faces."""
    corners = list(dict.fromkeys(spans(False)))
    if any(g.radius for g in corners):
        try:
            return _rounded(m, corners)
        except RefusalError:
            curved = _curved(m, spans, len(corners))
            if curved is None:
                raise
            return curved
    made = polytope.hull([g.center for g in corners])
    if made is None:
        return None
    curved = _curved(m, spans, len(made.planes)) if len(made.planes) > MOST_FACES else None
    shape = m.context.polytope(made.corners, made.planes, m.span)
    return curved or Solid(shape, points_hull(made.corners), is_convex=True)


def _curved(m: Invocation, spans: Callable[[bool], list[Generator]], pieces: int) -> Solid | None:
    """The hull with curves for what has few pieces, where that is exact."""
    with suppress(RefusalError):
        curves = list(dict.fromkeys(spans(True)))
        made = _rounded(m, curves) if any(g.radius for g in curves) else None
        if made is not None:
            m.context.warn(f"`{m.call.name}` of {pieces} faces or corners: shown with true curves instead", m.span)
            return made
    return None


def _rounded(m: Invocation, spans: Sequence[Generator]) -> Solid | None:
    """The solid hull of points, balls and discs; None where it is flat."""
    kept = list(dict.fromkeys(spans))
    discs = [g for g in kept if g.axis is not None]
    form = _of_discs(m, kept, discs[0].axis) if discs and discs[0].axis else rounded.solid(m.context, kept, m.span)
    return None if form is None else Solid(form, Spanned(lambda: kept), is_convex=True)


def _of_discs(m: Invocation, spans: Sequence[Generator], axis: Point) -> Shape | None:
    """All in a frame where the discs lie flat, if they all do: a tower between two planes, or a turned profile."""
    origin = next(g.center for g in spans if g.axis is not None)
    u, v = frame(axis)
    rows = tuple((*d, -(d[0] * origin[0] + d[1] * origin[1] + d[2] * origin[2])) for d in (u, v, axis))
    local = [(moved_point(rows, g.center), g) for g in spans]
    extent = max(max(map(abs, p)) + g.radius for p, g in local)
    for _, g in local:
        if g.axis is not None and abs(sum(a * b for a, b in zip(g.axis, axis, strict=True))) < 1.0 - NEAR * NEAR:
            raise RefusalError("the hull of discs that are not parallel has no exact form", GENERAL)
    if all(math.hypot(p[0], p[1]) <= NEAR * extent for p, _ in local):
        shape = _turned(m, local)
    else:
        shape = _tower(m, local, NEAR * extent)
    return None if shape is None else rounded.along(m.context, shape, origin, axis, m.span)


def _turned(m: Invocation, local: Sequence[tuple[Point, Generator]]) -> Shape | None:
    """Discs, balls and points around one axis: their hull in a half-plane, turned."""
    ends = [(p[2], g.radius) for p, g in local]
    if len(ends) == 2 and all(g.axis is not None or not g.radius for _, g in local):
        (low, bottom), (high, top) = sorted(ends)
        if low == high:
            return None
        context = m.context
        radii = {"bottom": context.number(bottom), "top": context.number(top)}
        shape = context.apply("capped_cone", m.span, **radii, height=context.number(high - low))
        return context.raised(shape, 0.5 * (low + high), m.span)
    discs: list[tuple[Point2, float]] = []
    for (_, _, z), g in local:
        discs += [((0.0, z), g.radius)] if g.axis is None else [((side * g.radius, z), 0.0) for side in (1.0, -1.0)]
    flat = plane.hull_of_discs(discs)
    return None if flat is None else Lathe(m.context, m.span, math.tau, False, None).turned(flat)


def _tower(m: Invocation, local: Sequence[tuple[Point, Generator]], near: float) -> Shape | None:
    """The same discs and points in two parallel planes: their hull in the plane, extruded."""
    if any(g.radius and g.axis is None for _, g in local):
        raise RefusalError("the hull of balls and discs has no exact form", GENERAL)
    low, high = min(p[2] for p, _ in local), max(p[2] for p, _ in local)
    if high - low <= near:
        return None
    flat = plane.hull_of_discs([((p[0], p[1]), g.radius) for p, g in local])
    ends = [[((p[0], p[1]), g.radius) for p, g in local if abs(p[2] - z) <= near] for z in (low, high)]
    if flat is None or not all(_covers(plane.hull_of_discs(end), flat, near) for end in ends):
        raise RefusalError("the hull of different discs at two heights has no exact form", GENERAL)
    return plane.fold(flat, Tower(m.context, m.span, low, high, 1.0, 1.0).solid)


def _covers(part: Plane | None, whole: Plane, near: float) -> bool:
    """Whether a hull of discs has all of another: its discs, and in their polygon the other's corners."""
    if part is None:
        return False
    discs, sides = _discs_and_sides(part)
    for (x, y), radius in plane.spanning_discs(whole):
        if radius and not any(math.dist(c, (x, y)) + abs(r - radius) <= near for c, r in discs):
            return False
        in_polygon = bool(sides) and all(a * x + b * y <= d + near for (a, b), d in sides)
        if not radius and not in_polygon and not any(math.dist(c, (x, y)) <= r + near for c, r in discs):
            return False
    return True


def _discs_and_sides(root: Plane) -> tuple[list[tuple[Point2, float]], list[outline.Edge]]:
    parts = root.children if isinstance(root, Joined) else (root,)
    discs = [(part.center, part.radius or 0.0) for part in parts if isinstance(part, Disc)]
    return discs, [side for part in parts if isinstance(part, Polygon) for side in outline.edges(part.points)]


def minkowski(m: Invocation) -> Part | None:
    """The sum of convex children: the hull of all sums of what spans them."""
    parts = m.parts()
    if not parts or None in m.children:
        return None
    if len(parts) == 1:
        return parts[0]
    if not all(p.is_convex for p in parts):
        raise RefusalError("`minkowski` of what is not convex has no distance form", "it is exact for convex children")
    if isinstance(parts[0], Flat):
        return _flat_hull(_flat_sums([plane.spanning_discs(p.plane) for p in parts if isinstance(p, Flat)]))
    return _spanned(m, lambda as_curves: _sums([generators(p.hull, as_curves) for p in parts if isinstance(p, Solid)]))


def _sums(terms: Sequence[list[Generator]]) -> list[Generator]:
    total = terms[0]
    for term in terms[1:]:
        if len(total) * len(term) > MOST_SUMS:
            raise RefusalError("this `minkowski` has too many corners")
        total = [_sum(a, b) for a in total for b in term]
    return total


def _flat_sums(terms: Sequence[list[tuple[Point2, float]]]) -> list[tuple[Point2, float]]:
    total = terms[0]
    for term in terms[1:]:
        total = [((a[0] + b[0], a[1] + b[1]), r + s) for a, r in total for b, s in term]
    return total


def _sum(a: Generator, b: Generator) -> Generator:
    """Of points, balls and parallel discs."""
    x, y, z = (p + q for p, q in zip(a.center, b.center, strict=True))
    axes = [g.axis for g in (a, b) if g.radius]
    for one, other in pairwise(axes):
        if one is None and other is None:
            continue
        if one is None or other is None or abs(sum(p * q for p, q in zip(one, other, strict=True))) < 1.0 - NEAR * NEAR:
            raise RefusalError(
                "this `minkowski` has no distance form", "discs add up with points and with parallel discs"
            )
    return Generator((x, y, z), a.radius + b.radius, axes[0] if axes else None)
