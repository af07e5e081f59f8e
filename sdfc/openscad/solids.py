"""OpenSCAD's solids: `cube`, `sphere`, `cylinder`, `polyhedron`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sdfc.openscad import polytope
from sdfc.openscad.generators import Generator, Spanned
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.part import Solid
from sdfc.openscad.polytope import Plane
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Point

Z: Point = (0.0, 0.0, 1.0)
Ring = tuple[float, float]  # radius and height of a ring of corners
SMALLEST = 1e-12  # a size below this is nothing
FLAT = 1e-5  # of the extent: how far a corner may be off a plane and count as on it (a .csg file has six digits)


def is_size(*values: float) -> bool:
    """Whether OpenSCAD makes anything of these sizes."""
    return all(math.isfinite(v) and v > SMALLEST for v in values)


def points_hull(corners: Sequence[Point]) -> Spanned:
    return Spanned(lambda: [Generator(p) for p in corners])


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
    rings = (facets + 1) // 2
    angles = [math.pi * (i + 0.5) / rings for i in range(rings)]
    return faceted(m, [(radius * math.sin(a), -radius * math.cos(a)) for a in angles], facets)


def cylinder(m: Invocation) -> Solid | None:
    height, bottom = m.number("h", 1.0), m.number("r1", m.number("r", 1.0))
    top = m.number("r2", m.number("r", 1.0))
    if not is_size(height, bottom + top) or min(bottom, top) < 0.0:
        return None
    low = -0.5 * height if m.flag("center") else 0.0
    facets = m.facets()
    if facets is not None:
        return faceted(m, [(bottom, low), (top, low + height)], facets)
    context = m.context
    upright = height * 0.5 + low
    if bottom == top:
        shape = context.apply("cylinder", m.span, radius=context.number(bottom), height=context.number(height))
    elif top == 0.0:
        shape = context.apply("cone", m.span, radius=context.number(bottom), height=context.number(height))
    else:
        numbers = {"bottom": bottom, "top": top, "height": height}
        shape = context.apply("capped_cone", m.span, **{name: context.number(v) for name, v in numbers.items()})
    discs = [Generator((0.0, 0.0, z), r, Z if r else None) for r, z in ((bottom, low), (top, low + height))]
    return Solid(context.raised(shape, upright, m.span), Spanned(lambda: discs), is_convex=True)


def faceted(m: Invocation, rings: Sequence[Ring], facets: int) -> Solid:
    """The convex solid of rings of corners, from the lowest up, each ring with its first corner at angle 0."""
    corners = ring_corners(rings, facets)
    shape = m.context.polytope(corners, ring_planes(rings, facets), m.span)
    return Solid(shape, points_hull(corners), is_convex=True)


def ring_corners(rings: Sequence[Ring], facets: int) -> list[Point]:
    angles = [math.tau * i / facets for i in range(facets)]
    made = [(r * math.cos(a), r * math.sin(a), z) for r, z in rings for a in (angles if r else angles[:1])]
    return made


def ring_planes(rings: Sequence[Ring], facets: int) -> list[Plane]:
    """The faces between rings, without the lowest and the highest. A face is flat: its middle is at r cos(pi / n)."""
    apothem = math.cos(math.pi / facets)
    planes = []
    for (r, z), (s, top) in pairwise(rings):
        across, up = top - z, apothem * (r - s)
        length = math.hypot(across, up)
        across, up = across / length, up / length
        offset = across * apothem * r + up * z
        for i in range(facets):
            angle = math.tau * (i + 0.5) / facets
            planes.append(((across * math.cos(angle), across * math.sin(angle), up), offset))
    return planes


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
