"""Solids of revolution that are primitives: balls, rings, cylinders and tubes."""

from __future__ import annotations

from typing import Protocol

from sdfc.diagnostics import Span
from sdfc.field.graph import Expr, FieldGraph, Operand
from sdfc.passes.convex import convex_sides, span_of
from sdfc.shape.definition import Argument
from sdfc.shape.graph import Affine, Apply, Paint, Shape, ShapeGraph
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix, identity
from sdfc.shape.stretch import is_similarity, smallest_stretch


class Making(Protocol):
    """What making a primitive takes."""

    @property
    def graph(self) -> ShapeGraph: ...

    @property
    def values(self) -> FieldGraph: ...

    def apply(self, name: str, span: Span, *arguments: Argument) -> Shape: ...

    def moved(self, shape: Shape, x: Operand, y: Operand) -> Shape: ...


def turned(shape: Apply, making: Making) -> Shape | None:
    """The primitive that a revolved circle or rectangle is, painted as its profile was."""
    profile, place = shape.children[0], identity(making.values)
    material: Material | None = None
    while not isinstance(profile, Apply):
        match profile:
            case Affine():
                place, profile = place.after(profile.forward), profile.child
            case Paint():
                material, profile = profile.material, profile.child  # the nearest one wins
            case _:
                return None
    (offset,) = shape.arguments
    if not profile.definition.is_standard or not place.is_constant or not _is_constant(offset, *profile.arguments):
        return None
    assert isinstance(offset, Expr)
    solid = _solid(profile, place, offset.number, shape.span, making)
    return solid if solid is None or material is None else making.graph.paint(material, solid, shape.span)


def _is_constant(*arguments: Argument) -> bool:
    return all(e.is_constant for a in arguments for e in (a if isinstance(a, tuple) else (a,)))


def _solid(profile: Apply, place: Matrix, offset: float, span: Span, making: Making) -> Shape | None:
    (size,) = profile.arguments if len(profile.arguments) == 1 else (None,)
    if not isinstance(size, Expr):
        return None
    match profile.definition.name:
        case "circle" if is_similarity(place, 2):
            radius = size.number * smallest_stretch(place, 2).number
            return _ring(place.offset[0].number + offset, place.offset[1].number, radius, span, making)
        case "rectangle":
            return _tube(place, offset, size.numbers[0] / 2.0, size.numbers[1] / 2.0, span, making)
        case _:
            return None


def _ring(x: float, y: float, radius: float, span: Span, making: Making) -> Shape | None:
    constant = making.values.constant
    if x == 0.0:
        return making.moved(making.apply("sphere", span, constant(radius)), 0.0, y)
    if x > radius:
        return making.moved(making.apply("torus", span, constant(x), constant(radius)), 0.0, y)
    return None


def _tube(place: Matrix, offset: float, x: float, y: float, span: Span, making: Making) -> Shape | None:
    """Where the rectangle's sides still run along the axes."""
    constant = making.values.constant
    corners = [
        (image[0].number, image[1].number)
        for image in (place.point((constant(a * x), constant(b * y), constant(0.0))) for a, b in _CORNERS)
    ]
    if any(min(abs(side.x), abs(side.y)) > 1e-12 for side in convex_sides(corners)):
        return None
    (left, low), (right, high) = span_of(corners)
    inner, outer, height = constant(left + offset), constant(right + offset), constant(high - low)
    if outer.number <= 0.0:
        return None
    hollow = inner.number > 0.0
    solid = (
        making.apply("tube", span, outer, inner, height) if hollow else making.apply("cylinder", span, outer, height)
    )
    return making.moved(solid, 0.0, (low + high) / 2.0)


_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
