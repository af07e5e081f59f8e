"""Extrusions and solids of revolution that are primitives become them: what has a closed form is then traced by it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

from sdfc.diagnostics import Span
from sdfc.field.graph import Expr, FieldGraph, Operand
from sdfc.passes.convex import Point, convex_sides, span_of
from sdfc.passes.rewrite import descend
from sdfc.passes.turned import turned
from sdfc.shape.definition import Argument, Definition
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Nothing,
    Paint,
    Shape,
    ShapeGraph,
    Union,
    definitions_of,
    topological,
)
from sdfc.shape.matrix import rotation, scaling, translation
from sdfc.shape.stretch import is_similarity, smallest_stretch

Lookup: TypeAlias = Callable[[str], Definition | None]


def recognise(root: Shape, graph: ShapeGraph, values: FieldGraph, definition: Lookup) -> Shape:
    """Afterwards no extrusion of circles, rectangles, convex polygons and their like is left, nor a revolved circle or
    rectangle, but for those that an operation changes: there the field must stay, here the solid does. An extrusion
    commutes with booleans, and so its profile may be one of them."""
    used = {definition.name: definition for definition in definitions_of(root) if definition.is_standard}
    if "extrude" not in used and "revolve" not in used:
        return root
    maker = Maker(graph, values, lambda name: used.get(name) or definition(name))
    return descend(root, None, maker.below, maker.made)


@dataclass(frozen=True, slots=True, eq=False)
class Maker:
    """Rewrites one scene. What is handed down is the height (an expression) of the extrusion that a profile is in, or
    None in space."""

    graph: ShapeGraph
    values: FieldGraph
    definition: Lookup

    def below(self, shape: Shape, height: Expr | None) -> list[tuple[Shape, Expr | None]]:
        match shape:
            case Apply() if height is None and _is(shape, "extrude") and _is_known(shape.children[0]):
                return [(shape.children[0], _length(shape))]
            case Apply():
                return []
            case Affine() if height is not None:
                return [(shape.child, height / self._scale(shape))]
            case Intersection() if height is not None and not all(map(_is_complement, shape.children)):
                return [self._longer(c, height) for c in shape.children]
            case Complement() if height is not None:
                return [self._longer(shape, height)]
            case _:
                return [(c, height) for c in shape.children]

    def made(self, shape: Shape, height: Expr | None, parts: tuple[Shape, ...]) -> Shape:
        if height is not None:
            return self._extruded(shape, height, parts)
        match shape:
            case Apply() if parts:
                return parts[0]
            case Apply() if _is(shape, "revolve"):
                return turned(shape, self) or shape
            case Apply():
                return shape
            case _:
                return self.graph.with_children(shape, parts)

    def apply(self, name: str, span: Span, *arguments: Argument) -> Shape:
        """A standard primitive with all its arguments."""
        found = self.definition(name)
        assert found is not None, f"there is no standard field '{name}'"
        return self.graph.apply(found, arguments, (), span)

    def moved(self, shape: Shape, x: Operand, y: Operand) -> Shape:
        """Moved across; the shape itself where it stays."""
        if all(isinstance(v, float) and v == 0.0 for v in (x, y)):
            return shape
        forward, back = translation(self.values, x, y, 0.0), translation(self.values, -x, -y, 0.0)
        return self.graph.affine(forward, back, shape, shape.span)

    def upright(self, name: str, span: Span, *arguments: Argument) -> Shape:
        """A primitive whose axis is y, along z: its own (x, z) are the profile's (x, y)."""
        forward, back = (rotation(self.values, 0, self.values.constant(a)) for a in (-math.pi / 2.0, math.pi / 2.0))
        return self.graph.affine(forward, back, self.apply(name, span, *arguments), span)

    def _longer(self, shape: Shape, height: Expr) -> tuple[Shape, Expr]:
        """What is cut away goes on beyond the ends, so that no faces coincide there."""
        match shape:
            case Complement():
                return shape.child, 2.0 * height
            case _:
                return shape, height

    def _scale(self, shape: Affine) -> Expr:
        """How much the height grows with the profile, so that the map stays a similarity in space."""
        factor = smallest_stretch(shape.forward, 2)
        similar = factor.is_constant and factor.number > 0.0 and is_similarity(shape.forward, 2)
        return factor if similar else self.values.constant(1.0)

    def _extruded(self, shape: Shape, height: Expr, parts: tuple[Shape, ...]) -> Shape:
        graph, span = self.graph, shape.span
        match shape:
            case Apply():
                return LEAVES[shape.definition.name](self, shape, height)
            case Affine():
                scale = self._scale(shape)
                grow, shrink = scaling(self.values, 1.0, 1.0, scale), scaling(self.values, 1.0, 1.0, 1.0 / scale)
                return graph.affine(shape.forward.after(grow), shrink.after(shape.inverse), parts[0], span)
            case Complement():
                upwards = self.values.constant(0.0, 0.0, 1.0)
                between = self.apply("slab", span, height, upwards)
                return graph.intersection([between, graph.complement(parts[0], span)], span)
            case Intersection() if not all(map(_is_complement, shape.children)):
                pairs = zip(shape.children, parts, strict=True)
                cut = [graph.complement(p, p.span) if _is_complement(c) else p for c, p in pairs]
                return graph.intersection(cut, span)
            case Nothing():
                return graph.nothing(span)
            case Union() | Intersection() | Paint():
                return graph.with_children(shape, parts)


def _circle(maker: Maker, shape: Apply, height: Expr) -> Shape:
    return maker.upright("cylinder", shape.span, *shape.arguments, height)


def _regular_polygon(maker: Maker, shape: Apply, height: Expr) -> Shape:
    return maker.upright("prism", shape.span, *shape.arguments, height)


def _ellipse(maker: Maker, shape: Apply, height: Expr) -> Shape:
    return maker.upright("elliptical_cylinder", shape.span, *shape.arguments, height)


def _ring(maker: Maker, shape: Apply, height: Expr) -> Shape:
    radius, thickness = numbers_of(shape)
    return maker.upright("tube", shape.span, radius + thickness / 2.0, radius - thickness / 2.0, height)


def _rectangle(maker: Maker, shape: Apply, height: Expr) -> Shape:
    (size,) = numbers_of(shape)
    return maker.apply("box", shape.span, maker.values.vector(size[0], size[1], height))


def _half_plane(maker: Maker, shape: Apply, height: Expr) -> Shape:
    normal, offset = numbers_of(shape)
    side = maker.apply("plane", shape.span, maker.values.vector(normal[0], normal[1], 0.0), offset)
    between = maker.apply("slab", shape.span, height, maker.values.constant(0.0, 0.0, 1.0))
    return maker.graph.intersection([side, between], shape.span)


def _polygon(maker: Maker, shape: Apply, height: Expr) -> Shape:
    """A box, and the sides that are not the box's own. The box gives the planes what they lack, an extent."""
    corners = corners_of(shape)
    (left, bottom), (right, top) = span_of(corners)
    size = maker.values.vector(right - left, top - bottom, height)
    box = maker.moved(maker.apply("box", shape.span, size), (left + right) / 2.0, (bottom + top) / 2.0)
    slanted = [side for side in convex_sides(corners) if min(abs(side.x), abs(side.y)) > 1e-12]
    if not slanted:
        return box
    normals = tuple(maker.values.constant(side.x, side.y, 0.0) for side in slanted)
    offsets = tuple(maker.values.constant(side.offset) for side in slanted)
    planes = maker.apply("convex_polyhedron", shape.span, normals, offsets)
    return maker.graph.intersection([box, planes], shape.span)


LEAVES: Mapping[str, Callable[[Maker, Apply, Expr], Shape]] = MappingProxyType(
    {
        "circle": _circle,
        "ellipse": _ellipse,
        "half_plane": _half_plane,
        "polygon": _polygon,
        "rectangle": _rectangle,
        "regular_polygon": _regular_polygon,
        "ring": _ring,
        "trapezoid": _polygon,
    }
)


def corners_of(shape: Apply) -> list[Point]:
    """The corners of a polygon or a trapezoid; none where they are not constants."""
    arguments = [e for a in shape.arguments for e in (a if isinstance(a, tuple) else (a,))]
    if not all(e.is_constant for e in arguments):
        return []
    if shape.definition.name == "polygon":
        return [(e.numbers[0], e.numbers[1]) for e in arguments]
    bottom, top, height = (e.number for e in arguments)
    low, high = -height / 2.0, height / 2.0
    return [(-bottom, low), (bottom, low), (top, high), (-top, high)]


def numbers_of(shape: Apply) -> list[Expr]:
    """The arguments of a primitive that takes no lists."""
    return [a for a in shape.arguments if isinstance(a, Expr)]


def _length(extrusion: Apply) -> Expr:
    (height,) = numbers_of(extrusion)
    return height


def _is(shape: Apply, name: str) -> bool:
    return shape.definition.is_standard and shape.definition.name == name


def _is_complement(shape: Shape) -> bool:
    match shape:
        case Complement():
            return True
        case _:
            return False


def _is_known(profile: Shape) -> bool:
    """Whether every leaf below has a solid."""
    return all(_is_leaf(node) for node in topological(profile) if isinstance(node, Apply))


def _is_leaf(shape: Apply) -> bool:
    if not shape.definition.is_standard or shape.definition.name not in LEAVES:
        return False
    return LEAVES[shape.definition.name] is not _polygon or bool(convex_sides(corners_of(shape)))
