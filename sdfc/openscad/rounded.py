"""The convex hull of balls and points: the polytope through all points of tangency, and a round cone for each edge.

An edge is a pair of balls that some supporting plane touches. The planes that touch both balls i and j have their
normals on a circle; every other ball leaves an arc of it, and where an arc ends a plane touches a third ball. (The
additively weighted convex hull: Boissonnat, Cerezo, Devillers, Duquesne and Yvinec, 1996.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sdfc.diagnostics import Span
from sdfc.openscad import polytope
from sdfc.openscad.context import Context
from sdfc.openscad.generators import Generator
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Point, dot, frame, translation
from sdfc.shape.graph import Shape

MOST = 200  # balls that are not within others
SHORTEST_ARC = 1e-6  # radians: less is the file's rounding
SAME = 1e-6  # relative

Arc = tuple[float, float]


def solid(context: Context, balls: Sequence[Generator], span: Span) -> Shape:
    """At least one of the balls has a radius above 0."""
    kept = _outermost(balls)
    if len(kept) > MOST:
        raise RefusalError(f"the hull of more than {MOST} balls is too much work")
    if len(kept) == 1:
        return _ball(context, kept[0], span)
    box = _box_corners(kept)
    if box is not None:
        return _rounded_box(context, *box, kept[0].radius, span)
    touched: list[Point] = []
    shapes: list[Shape] = []
    for i, a in enumerate(kept):
        for b in kept[:i]:
            normals = _edge(a, b, kept)
            if normals is None:
                continue
            touched.extend(_along(g.center, n, g.radius) for n in normals for g in (a, b))
            if a.radius or b.radius:
                shapes.append(_round_cone(context, a, b, span))
    core = polytope.hull(touched) if touched else None
    if core is not None:
        shapes.insert(0, context.polytope(core.corners, core.planes, span))
    return context.shapes.union(shapes, span) if len(shapes) > 1 else shapes[0]


def _outermost(balls: Sequence[Generator]) -> list[Generator]:
    """Without balls within others; of many equal balls only those at corners of their centres' hull."""
    kept: list[Generator] = []
    for ball in sorted(balls, key=lambda b: -b.radius):
        if all(math.dist(ball.center, k.center) + ball.radius > k.radius * (1.0 + 1e-12) for k in kept):
            kept.append(ball)
    radii = {b.radius for b in kept}
    corners = polytope.hull([b.center for b in kept]) if len(radii) == 1 and len(kept) > 8 else None
    return kept if corners is None else [Generator(p, kept[0].radius) for p in corners.corners]


def _along(p: Point, direction: Point, distance: float) -> Point:
    return p[0] + distance * direction[0], p[1] + distance * direction[1], p[2] + distance * direction[2]


def _edge(a: Generator, b: Generator, every: Sequence[Generator]) -> list[Point] | None:
    """The normals of the planes that touch a, b and a third ball, all others below; None where a, b are no edge."""
    length = math.dist(a.center, b.center)
    u = _along((0.0, 0.0, 0.0), _along(a.center, b.center, -1.0), 1.0 / length)
    cosine = (b.radius - a.radius) / length
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    v, w = frame(u)
    forbidden: list[Arc] = []
    for other in every:
        if other is a or other is b:
            continue
        to = _along(other.center, a.center, -1.0)
        x, y = sine * dot(v, to), sine * dot(w, to)
        room = a.radius - other.radius - cosine * dot(u, to)  # x cos t + y sin t <= room
        reach, slack = math.hypot(x, y), SAME * 1e-3 * (length + abs(room))
        if room >= reach - slack:
            continue
        if room <= -reach:
            return None
        middle, half = math.atan2(y, x), math.acos(room / reach)
        forbidden.append(((middle - half) % math.tau, 2.0 * half))
    ends = _free_ends(forbidden)
    if ends is None:
        return None
    return [_along(_along(_along((0, 0, 0), u, cosine), v, sine * math.cos(t)), w, sine * math.sin(t)) for t in ends]


def _free_ends(forbidden: Sequence[Arc]) -> list[float] | None:
    """The ends of what arcs (start, length) leave of a circle: [] where there are none, None where nothing is left."""
    if not forbidden:
        return []
    ordered = sorted(forbidden)
    ends: list[float] = []
    reached = max(start + length for start, length in ordered) - math.tau  # what comes around from the end
    for start, length in ordered:
        if start > reached + SHORTEST_ARC:
            ends += [reached, start]
        reached = max(reached, start + length)
    return ends or None


def _ball(context: Context, ball: Generator, span: Span) -> Shape:
    return _placed(context, context.apply("sphere", span, radius=context.number(ball.radius)), ball.center, span)


def _placed(context: Context, shape: Shape, p: Point, span: Span) -> Shape:
    return context.moved(translation(p), shape, span)


def along(context: Context, shape: Shape, p: Point, axis: Point, span: Span) -> Shape:
    """A shape made along z, with its z axis turned to a unit `axis` and its origin moved to `p`."""
    u, v = frame(axis)
    x, y, z = ((u[i], v[i], axis[i], p[i]) for i in range(3))
    return context.moved((x, y, z), shape, span)


def _round_cone(context: Context, a: Generator, b: Generator, span: Span) -> Shape:
    """The hull of two balls; one may be a point."""
    if a.radius == b.radius:
        ends = {"from": context.vector(a.center), "to": context.vector(b.center)}
        return context.apply("capsule", span, **ends, radius=context.number(a.radius))
    if a.radius < b.radius:
        a, b = b, a
    length = math.dist(a.center, b.center)
    axis = _along((0.0, 0.0, 0.0), _along(b.center, a.center, -1.0), 1.0 / length)
    if b.radius == 0.0:
        return _cone_on_ball(context, a, length, axis, span)
    radii = {"bottom": context.number(a.radius), "top": context.number(b.radius)}
    shape = context.apply("round_cone", span, **radii, height=context.number(length))
    middle = _along(a.center, axis, 0.5 * length)
    return along(context, context.raised(shape, 0.0, span), middle, axis, span)


def _cone_on_ball(context: Context, ball: Generator, length: float, axis: Point, span: Span) -> Shape:
    """A ball, and the cone that touches it with its tip `length` from the centre."""
    sine = ball.radius / length
    low = ball.radius * sine  # where the cone begins, from the centre
    rim = ball.radius * math.sqrt(max(1.0 - sine * sine, 0.0))
    cone = context.apply("cone", span, radius=context.number(rim), height=context.number(length - low))
    middle = _along(ball.center, axis, 0.5 * (low + length))
    tip = along(context, context.raised(cone, 0.0, span), middle, axis, span)
    return context.shapes.union((_ball(context, ball, span), tip), span)


def _box_corners(balls: Sequence[Generator]) -> tuple[Point, Point] | None:
    """The corners of an upright box, where equal balls are at its eight corners."""
    if len(balls) != 8 or len({b.radius for b in balls}) > 1:
        return None
    lo, hi = (tuple(end(b.center[i] for b in balls) for i in range(3)) for end in (min, max))
    near = SAME * max(b - a for a, b in zip(lo, hi, strict=True))
    found = set()
    for ball in balls:
        for i in range(3):
            if min(abs(ball.center[i] - lo[i]), abs(ball.center[i] - hi[i])) > near:
                return None
        found.add(tuple(abs(ball.center[i] - lo[i]) <= near for i in range(3)))
    if len(found) < 8:
        return None
    return (lo[0], lo[1], lo[2]), (hi[0], hi[1], hi[2])


def _rounded_box(context: Context, lo: Point, hi: Point, radius: float, span: Span) -> Shape:
    size = [b - a + 2.0 * radius for a, b in zip(lo, hi, strict=True)]
    shape = context.apply("rounded_box", span, size=context.vector(size), radius=context.number(radius))
    x, y, z = (0.5 * (a + b) for a, b in zip(lo, hi, strict=True))
    return _placed(context, shape, (x, y, z), span)
