"""OpenSCAD's solids: `cube`, `sphere`, `cylinder`, `polyhedron`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sdfc.openscad import polytope, space
from sdfc.openscad.generators import Faceted, Generator, Spanned
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.part import Solid
from sdfc.openscad.polytope import Plane
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Point

Z: Point = (0.0, 0.0, 1.0)
Ring = tuple[float, float]  # radius and height of a ring of corners
MOST_PLANES = 12  # faces around a cylinder that each become a plane; with more of them one is folded onto the others
SMALLEST = 1e-12  # a size below this is nothing
FLAT = 1e-5  # of the extent: how far a corner may be off a plane and count as on it (a .csg file has six digits)


def is_size(*values: float) -> bool:
    """Whether OpenSCAD makes anything of these sizes."""
    return all(math.isfinite(v) and v > SMALLEST for v in values)


def points_hull(corners: Sequence[Point]) -> Spanned:
    return Spanned(lambda: _points(corners))


def cube(m: Invocation) -> Solid | None:
    size = m.numbers("size", 3, 1.0)
    if not is_size(*size):
        return None
    shift = -0.5 if m.flag("center") else 0.0
    x, y, z = (shift * s for s in size)
    lo, hi = (x, y, z), (x + size[0], y + size[1], z + size[2])
    corners = [(a, b, c) for a in (lo[0], hi[0]) for b in (lo[1], hi[1]) for c in (lo[2], hi[2])]
    return Solid(m.context.box(lo, hi, m.span), points_hull(corners), is_convex=True)


def sphere(m: Invocation) -> Solid | None:
    radius = m.number("r", 1.0)
    if not is_size(radius):
        return None
    facets = m.facets()
    if facets is None:
        shape = m.context.apply("sphere", m.span, radius=m.context.number(radius))
        return Solid(shape, Spanned(lambda: [Generator((0.0, 0.0, 0.0), radius)]), is_convex=True)
    return _faceted_ball(m, radius, facets)


def _faceted_ball(m: Invocation, radius: float, facets: int) -> Solid:
    """OpenSCAD's rings, none at the poles. Only the upper half's faces are needed: the lower one mirrors it."""
    count = (facets + 1) // 2
    angles = [math.pi * (i + 0.5) / count for i in range(count)]
    rings = [(radius * math.sin(a), -radius * math.cos(a)) for a in angles]
    context = m.context
    faces = [_slope(low, high, facets) for low, high in pairwise(rings) if low[1] + high[1] > -1e-9 * radius]
    shape = context.apply(
        "faceted_ball",
        m.span,
        sides=context.number(facets),
        normals=tuple(context.vector(normal) for normal, _ in faces),
        offsets=tuple(context.number(offset) for _, offset in faces),
        radius=context.number(max(r for r, _ in rings)),
        height=context.number(rings[-1][1]),
    )
    curve = [Generator((0.0, 0.0, 0.0), radius)]
    return Solid(shape, Faceted(lambda: _points(ring_corners(rings, facets)), lambda: curve), is_convex=True)


def cylinder(m: Invocation) -> Solid | None:
    height, bottom = m.number("h", 1.0), m.number("r1", m.number("r", 1.0))
    top = m.number("r2", m.number("r", 1.0))
    if not is_size(height, bottom + top) or min(bottom, top) < 0.0:
        return None
    low = -0.5 * height if m.flag("center") else 0.0
    facets = m.facets()
    context = m.context
    ends = ((bottom, low), (top, low + height))
    discs = [Generator((0.0, 0.0, z), r, Z if r else None) for r, z in ends]
    if facets is not None:
        corners = ring_corners(ends, facets)
        if facets <= MOST_PLANES:
            shape = context.polytope(corners, ring_planes(ends, facets), m.span)
        else:
            sizes = {"sides": facets, "bottom": bottom, "top": top, "height": height}
            shape = context.apply("faceted_cone", m.span, **{name: context.number(v) for name, v in sizes.items()})
            shape = context.moved(space.translation((0.0, 0.0, low + 0.5 * height)), shape, m.span)
        return Solid(shape, Faceted(lambda: _points(corners), lambda: discs), is_convex=True)
    if bottom == top:
        shape = context.apply("cylinder", m.span, radius=context.number(bottom), height=context.number(height))
    elif top == 0.0:
        shape = context.apply("cone", m.span, radius=context.number(bottom), height=context.number(height))
    else:
        sizes = {"bottom": bottom, "top": top, "height": height}
        shape = context.apply("capped_cone", m.span, **{name: context.number(v) for name, v in sizes.items()})
    return Solid(context.raised(shape, low + 0.5 * height, m.span), Spanned(lambda: discs), is_convex=True)


def _points(corners: Sequence[Point]) -> list[Generator]:
    return [Generator(p) for p in corners]


def ring_corners(rings: Sequence[Ring], facets: int) -> list[Point]:
    angles = [math.tau * i / facets for i in range(facets)]
    made = [(r * math.cos(a), r * math.sin(a), z) for r, z in rings for a in (angles if r else angles[:1])]
    return made


def _slope(low: Ring, high: Ring, facets: int) -> tuple[tuple[float, float], float]:
    """The face between two rings, in the plane of its middle: normal (outward, up) and offset."""
    apothem = math.cos(math.pi / facets)
    across, up = high[1] - low[1], apothem * (low[0] - high[0])
    length = math.hypot(across, up)
    across, up = across / length, up / length
    return (across, up), across * apothem * low[0] + up * low[1]


def ring_planes(ends: tuple[Ring, Ring], facets: int) -> list[Plane]:
    """The faces between two rings, without the horizontal ones."""
    (across, up), offset = _slope(*ends, facets)
    angles = [math.tau * (i + 0.5) / facets for i in range(facets)]
    return [((across * math.cos(a), across * math.sin(a), up), offset) for a in angles]


def polyhedron(m: Invocation) -> Solid | None:
    """A convex one: the planes of its hull, where every face lies on one of them."""
    points = [(p[0], p[1], p[2]) for p in m.points("points", 3)]
    faces = m.indices("faces" if m.argument("faces") else "triangles", len(points))
    faces = [face for face in faces if len(face) >= 3]
    used = [points[i] for i in sorted({i for face in faces for i in face})]
    hull = polytope.hull(used)
    if hull is None:
        return None
    near = FLAT * max(max(p[axis] for p in used) - min(p[axis] for p in used) for axis in range(3))
    for face in faces:
        corners = [points[i] for i in face]
        if not any(all(abs(_height(plane, p)) <= near for p in corners) for plane in hull.planes):
            raise RefusalError(
                "a `polyhedron` that is not convex has no exact form", "put it together from convex ones"
            )
    return Solid(m.context.polytope(hull.corners, hull.planes, m.span), points_hull(hull.corners), is_convex=True)


def _height(plane: Plane, p: Point) -> float:
    (a, b, c), d = plane
    return a * p[0] + b * p[1] + c * p[2] - d
