"""From the plane to space: `linear_extrude` and `rotate_extrude`.

Both commute with booleans: each polygon and disc becomes a solid by itself, with a closed form where there is one.
"""

from __future__ import annotations

import math

from sdfc.openscad import plane
from sdfc.openscad.generators import Generator, Spanned, refused
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.lathe import Lathe
from sdfc.openscad.part import Solid
from sdfc.openscad.plane import Plane
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.solids import Z, is_size
from sdfc.openscad.tower import Tower


def linear_extrude(m: Invocation) -> Solid | None:
    flats = m.flats()
    height = m.number("height", m.number("h", 100.0))
    if not flats or not is_size(height):
        return None
    twist = math.radians(m.number("twist", 0.0))
    scale = tuple(max(s, 0.0) for s in m.numbers("scale", 2, 1.0))
    if not all(map(math.isfinite, (twist, *scale))):
        raise m.wrong("twist" if not math.isfinite(twist) else "scale", "finite")
    low = -0.5 * height if m.flag("center") else 0.0
    root = plane.joined(flats)
    tower = Tower(m.context, m.span, low, low + height, scale[0], scale[1])
    if twist:
        shape = tower.twisted(root, twist)
        return Solid(shape, refused("the hull of a twisted extrusion has no exact form"), is_convex=False)
    is_convex = len(flats) == 1 and all(c.is_convex for c in m.parts())
    shape = plane.fold(root, tower.solid)
    return Solid(shape, Spanned(lambda: _extruded_hull(root, tower)), is_convex)


def _extruded_hull(root: Plane, tower: Tower) -> list[Generator]:
    made = []
    for (x, y), radius in plane.spanning_discs(root):
        for z, a, b in ((tower.low, 1.0, 1.0), (tower.high, tower.x, tower.y)):
            if radius and a != b:
                raise RefusalError("the hull of this extrusion has no exact form")
            made.append(Generator((a * x, b * y, z), a * radius, Z if a * radius else None))
    return made


def rotate_extrude(m: Invocation) -> Solid | None:
    flats = m.flats()
    angle = m.number("angle", 360.0)
    if not flats or angle == 0.0:
        return None
    if not -360.0 < angle < 360.0:  # also what is not a number
        angle = 360.0
    root = plane.joined(flats)
    box = plane.extent(root)
    if box is None:
        return None
    lo, hi = box[0][0], box[1][0]
    margin = 1e-6 * (hi - lo)
    if lo < -margin and hi > margin and plane.is_tight(root):
        raise RefusalError(
            "this shape lies on both sides of the axis", "all of it must have x >= 0, or all of it x <= 0"
        )
    is_mirrored = -lo > hi
    if is_mirrored:
        root = plane.moved(root, ((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    lathe = Lathe(m.context, m.span, math.radians(angle), is_mirrored, m.facets())
    shape = lathe.turned(root)
    return None if shape is None else Solid(shape, _turned_hull(root, lathe), is_convex=False)


def _turned_hull(root: Plane, lathe: Lathe) -> Spanned:
    if not lathe.is_full or lathe.facets is not None:
        return refused("the hull of this `rotate_extrude` has no exact form")

    def make() -> list[Generator]:
        made = []
        for (x, z), radius in plane.spanning_discs(root):
            if radius and abs(x) > 1e-9 * radius:
                raise RefusalError("the hull of a ring has no exact form")
            is_disc = x > 0.0 and not radius
            made.append(Generator((0.0, 0.0, z), x if is_disc else radius, Z if is_disc else None))
        return made

    return Spanned(make)
