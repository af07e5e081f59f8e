"""OpenSCAD's shapes in the plane: `circle`, `square`, `polygon`, and `offset`."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sdfc.openscad import outline, plane
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.outline import Point2
from sdfc.openscad.part import Flat
from sdfc.openscad.plane import Common, Joined, Outside, Plane, Polygon
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.solids import is_size


def circle(m: Invocation) -> Flat | None:
    radius, facets = m.number("r", 1.0), m.facets()
    if not is_size(radius):
        return None
    return Flat(plane.circle(radius) if facets is None else Polygon(outline.regular(facets, radius)), is_convex=True)


def square(m: Invocation) -> Flat | None:
    width, height = m.numbers("size", 2, 1.0)
    if not is_size(width, height):
        return None
    x, y = (-0.5 * width, -0.5 * height) if m.flag("center") else (0.0, 0.0)
    return Flat(Polygon(((x, y), (x + width, y), (x + width, y + height), (x, y + height))), is_convex=True)


def polygon(m: Invocation) -> Flat | None:
    """One closed line, or several: what is within an odd number of them."""
    points = [(p[0], p[1]) for p in m.points("points", 2)]
    paths: Sequence[tuple[int, ...]] = [tuple(range(len(points)))]
    if m.value("paths") is not None:
        paths = m.indices("paths", len(points)) or paths
    lines = [line for line in (outline.cleaned([points[i] for i in path]) for path in paths) if line]
    if not lines:
        return None
    if len(lines) == 1:
        return Flat(Polygon(lines[0]), is_convex=outline.is_convex(lines[0]))
    return Flat(_nested(lines) if _are_apart(lines) else _parity(lines), is_convex=False)


def _are_apart(lines: Sequence[tuple[Point2, ...]]) -> bool:
    """Whether no two lines meet, and none meets itself."""
    for i, line in enumerate(lines):
        if not outline.is_simple(line):
            return False
        for other in lines[:i]:
            sides = [(other[j - 1], other[j]) for j in range(len(other))]
            if any(outline.meet(line[k - 1], line[k], *side) for k in range(len(line)) for side in sides):
                return False
    return True


def _nested(lines: Sequence[tuple[Point2, ...]]) -> Plane:
    """Lines that do not meet: each of even depth, without those one deeper within it."""
    around = [
        {j for j, o in enumerate(lines) if j != i and outline.contains(o, line[0])} for i, line in enumerate(lines)
    ]
    parts: list[Plane] = []
    for i, line in enumerate(lines):
        if len(around[i]) % 2 == 0:
            holes = [Polygon(lines[j]) for j in range(len(lines)) if around[j] == around[i] | {i}]
            parts.append(plane.without(Polygon(line), holes) if holes else Polygon(line))
    return plane.joined(parts)


def _parity(lines: Sequence[tuple[Point2, ...]]) -> Plane:
    """Lines that cross: exclusive or, one after the other."""
    result: Plane = Polygon(lines[0])
    for line in lines[1:]:
        other = Polygon(line)
        result = Joined((Common((result, Outside(other))), Common((other, Outside(result)))))
    return result


def offset(m: Invocation) -> Flat | None:
    """By `r` with round corners (always true arcs), or by `delta` with sharp ones."""
    flats = m.flats()
    if not flats:
        return None
    child = plane.joined(flats)
    radius = m.number("r", 0.0)
    delta = m.number("delta", 0.0)
    if not (math.isfinite(radius) and math.isfinite(delta)):
        raise m.wrong("r" if m.argument("r") else "delta", "finite")
    if delta and m.flag("chamfer"):
        raise RefusalError("`offset` with cut corners has no exact form here", "`chamfer = false`, or `r`, has one")
    made = plane.mitred(child, delta) if delta else plane.grown(child, radius)
    parts = m.parts()
    return None if made is None else Flat(made, is_convex=len(parts) == 1 and parts[0].is_convex)
