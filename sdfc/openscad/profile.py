"""A shape in the plane as one field, for what has no closed form in space."""

from __future__ import annotations

from typing import assert_never

from sdfc.diagnostics import Span
from sdfc.openscad import plane
from sdfc.openscad.context import Context
from sdfc.openscad.plane import Common, Disc, Joined, Outside, Plane, Polygon, Stroke
from sdfc.shape.graph import Shape


def profile(context: Context, root: Plane, span: Span) -> Shape:
    """The shape in the plane, as one."""

    def made(node: Plane, _: int, parts: list[Shape]) -> Shape:
        match node:
            case Polygon():
                return context.apply("polygon", span, points=tuple(context.vector(p) for p in node.points))
            case Disc():
                return _disc(context, node, span)
            case Stroke():
                points = tuple(context.vector(p) for p in (*node.points, node.points[0]))
                return context.apply("stroke", span, points=points, radius=context.number(node.radius))
            case Joined():
                return context.shapes.union(parts, span)
            case Common():
                return context.shapes.intersection(parts, span)
            case Outside():
                return context.shapes.complement(parts[0], span)
            case _:
                assert_never(node)

    return plane.fold(root, made)


def _disc(context: Context, disc: Disc, span: Span) -> Shape:
    radius = disc.radius
    shape = context.apply("circle", span, radius=context.number(radius or 1.0))
    (a, b, x), (c, d, y) = disc.map
    if radius is not None:
        a, b, c, d = 1.0, 0.0, 0.0, 1.0
    return context.moved(((a, b, 0.0, x), (c, d, 0.0, y), (0.0, 0.0, 1.0, 0.0)), shape, span)
