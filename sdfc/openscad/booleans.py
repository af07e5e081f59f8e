"""What puts children together or changes how they look and lie: booleans, `color`, `multmatrix`, `resize`."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sdfc.diagnostics import scene_error
from sdfc.openscad import plane
from sdfc.openscad.colors import material_of
from sdfc.openscad.generators import Mapped, Together, generators, moved, refused
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.part import Flat, Part, Solid
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Map3

SINGULAR = 1e-9  # of the product of the columns' lengths


def union(m: Invocation) -> Part | None:
    """`union`, `group`, `render`, and a file: all children together."""
    parts = m.parts()
    if len(parts) <= 1:
        return parts[0] if parts else None
    flats = [p.plane for p in parts if isinstance(p, Flat)]
    if flats:
        return Flat(plane.joined(flats), is_convex=False)
    solids = [p for p in parts if isinstance(p, Solid)]
    shape = m.context.shapes.union([s.shape for s in solids], m.span)
    return Solid(shape, Together(tuple(s.hull for s in solids)), is_convex=False)


def intersection(m: Invocation) -> Part | None:
    """Nothing, where a child is nothing."""
    parts = m.parts()
    if not parts or None in m.children:
        return None
    if len(parts) == 1:
        return parts[0]
    is_convex = all(p.is_convex for p in parts)
    flats = [p.plane for p in parts if isinstance(p, Flat)]
    if flats:
        return Flat(plane.Common(tuple(flats)), is_convex)
    shape = m.context.shapes.intersection([p.shape for p in parts if isinstance(p, Solid)], m.span)
    return Solid(shape, refused("the hull of an intersection has no exact form"), is_convex)


def difference(m: Invocation) -> Part | None:
    """The first child without the others. It is nothing where the first child is nothing."""
    parts = m.parts()
    if not m.children or m.children[0] is None:
        return None
    first, rest = parts[0], parts[1:]
    if not rest:
        return first
    match first:
        case Flat():
            return Flat(plane.without(first.plane, [p.plane for p in rest if isinstance(p, Flat)]), is_convex=False)
        case Solid():
            taken = [p.shape for p in rest if isinstance(p, Solid)]
            shape = m.context.shapes.difference(first.shape, taken, m.span)
            return Solid(shape, refused("the hull of a difference has no exact form"), is_convex=False)


def color(m: Invocation) -> Part | None:
    """Paint, where no colour outside of this one rules."""
    part = union(m)
    material = None if m.is_painted else material_of(m)
    if material is None or not isinstance(part, Solid):
        return part
    return Solid(m.context.shapes.paint(material, part.shape, m.span), part.hull, part.is_convex)


def multmatrix(m: Invocation) -> Part | None:
    """The children under an affine map; OpenSCAD ignores the last row."""
    part = union(m)
    return part if part is None else _moved(m, part, _matrix(m))


def _matrix(m: Invocation) -> Map3:
    expected = "a matrix: 4 rows, each of 4 finite numbers"
    rows = m.points("m", 4, expected)[:3]
    if len(rows) < 3:
        raise m.wrong("m", expected)
    return tuple((row[0], row[1], row[2], row[3]) for row in rows)


def _moved(m: Invocation, part: Part, move: Map3) -> Part:
    if _is_singular([row[:2] for row in move[:2]] if isinstance(part, Flat) else [row[:3] for row in move]):
        hint = "a scale of 0, or a plane turned on edge: nothing with a volume is left"
        raise scene_error("this matrix is singular: it makes its children flat", m.span, hint)
    match part:
        case Flat():
            ((a, b, _, x), (c, d, _, y), _) = move
            return Flat(plane.moved(part.plane, ((a, b, x), (c, d, y))), part.is_convex)
        case Solid():
            shape = m.context.moved(move, part.shape, m.span)
            return Solid(shape, Mapped(lambda g: (moved(move, g),), part.hull), part.is_convex)


def _is_singular(rows: Sequence[Sequence[float]]) -> bool:
    lengths = [math.hypot(*column) for column in zip(*rows, strict=True)]
    if 0.0 in lengths:
        return True
    unit = [[value / length for value, length in zip(row, lengths, strict=True)] for row in rows]
    if len(rows) == 2:
        volume = unit[0][0] * unit[1][1] - unit[0][1] * unit[1][0]
    else:
        (a, b, c), (d, e, f), (g, h, i) = unit
        volume = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return abs(volume) < SINGULAR


def resize(m: Invocation) -> Part | None:
    """Scaled about the origin until the box around has a size; 0 keeps an axis, or with `auto` scales it alike."""
    part = union(m)
    if part is None:
        return None
    old = _size(part)
    new = list(m.numbers("newsize", 3, 0.0))[: len(old)]
    if isinstance(part, Flat):
        new = new[:2]
    auto = _auto(m)
    if not all(math.isfinite(v) for v in new):
        raise m.wrong("newsize", "finite")
    factors = [n / o if n > 0.0 and o > 0.0 else 1.0 for n, o in zip(new, old, strict=True)]
    largest = max(range(len(new)), key=lambda i: new[i])
    for i, size in enumerate(new):
        if size <= 0.0 and auto[i]:
            factors[i] = factors[largest]
    x, y, z = (*factors, 1.0)[:3]
    return _moved(m, part, ((x, 0.0, 0.0, 0.0), (0.0, y, 0.0, 0.0), (0.0, 0.0, z, 0.0)))


def _auto(m: Invocation) -> tuple[bool, ...]:
    match m.value("auto"):
        case None:
            return (False,) * 3
        case bool(value):
            return (value,) * 3
        case tuple(values) if len(values) == 3:
            return tuple(bool(v) for v in values)
        case _:
            raise m.wrong("auto", "a list of 3 flags")


def _size(part: Part) -> list[float]:
    match part:
        case Flat():
            box = plane.extent(part.plane)
            if box is None or not plane.is_tight(part.plane):
                raise RefusalError("the size of this is not known, so that `resize` cannot scale it")
            return [box[1][0] - box[0][0], box[1][1] - box[0][1]]
        case Solid():
            spans = generators(part.hull)
            sizes = []
            for axis in range(3):
                reach = [(g.center[axis], g.reach(axis)) for g in spans]
                sizes.append(max(c + r for c, r in reach) - min(c - r for c, r in reach))
            return sizes
