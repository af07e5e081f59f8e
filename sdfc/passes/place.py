"""Transforms are composed in float64 and carried to the leaves; uniform scales go into sizes."""

from __future__ import annotations

from typing import TypeAlias, assert_never

from sdfc.facts.pointwise import is_pointwise
from sdfc.field.graph import Expr, FieldGraph
from sdfc.passes.rewrite import descend
from sdfc.shape.definition import Argument
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union
from sdfc.shape.matrix import Matrix, identity, scaling
from sdfc.shape.stretch import is_similarity, smallest_stretch

Place: TypeAlias = tuple[Matrix, Matrix]  # a map and its inverse


def place(root: Shape, graph: ShapeGraph, values: FieldGraph) -> Shape:
    """Afterwards an Affine stands only directly on an Apply, and none is the identity. A uniform scale has gone into the
    lengths of every definition that is dimensionally consistent. Solids are the same sets; fields are the same where maps
    are similarities."""
    placer = _Placer(graph, values)
    return descend(root, placer.nowhere, placer.below, placer.make)


class _Placer:
    def __init__(self, graph: ShapeGraph, values: FieldGraph) -> None:
        self._graph = graph
        self._values = values
        self.nowhere: Place = (identity(values), identity(values))
        self._pointwise: dict[tuple[object, ...], bool] = {}

    def below(self, shape: Shape, place: Place) -> list[tuple[Shape, Place]]:
        match shape:
            case Affine():
                forward, inverse = place
                return [(shape.child, (forward.after(shape.forward), shape.inverse.after(inverse)))]
            case Union() | Intersection():
                return [(c, place) for c in shape.children]
            case Complement() | Paint():
                return [(shape.child, place)]
            case Apply():
                inner = self.nowhere if self._scale_for_children(shape, place) is None else place
                return [(c, inner) for c in shape.children]
            case Nothing():
                return []
            case _:
                assert_never(shape)

    def make(self, shape: Shape, place: Place, children: tuple[Shape, ...]) -> Shape:
        match shape:
            case Affine():
                return children[0]
            case Apply() if shape.children:
                return self._operation(shape, place, children)
            case Apply():
                return self._primitive(shape, place)
            case _:
                return self._graph.with_children(shape, children)

    def _operation(self, shape: Apply, place: Place, children: tuple[Shape, ...]) -> Shape:
        scale = self._scale_for_children(shape, place)
        if scale is None:
            return self._moved(self._graph.with_children(shape, children), place)
        return self._graph.apply(shape.definition, _scaled(shape, scale), children, shape.span)

    def _primitive(self, shape: Apply, place: Place) -> Shape:
        scale = self._scale(shape, place)
        if scale is None or scale.number == 1.0:
            return self._moved(shape, place)
        forward, inverse = place
        shrink, grow = self._uniform(1.0 / scale, shape.dimension), self._uniform(scale, shape.dimension)
        rigid = forward.after(shrink).tidied(), grow.after(inverse).tidied()
        return self._moved(self._graph.apply(shape.definition, _scaled(shape, scale), (), shape.span), rigid)

    def _scale(self, shape: Apply, place: Place) -> Expr | None:
        """The factor that may go into the definition's lengths: a number, of a map that stretches all alike."""
        forward, _ = place
        if not shape.definition.claims.homogeneous or not is_similarity(forward, shape.dimension):
            return None
        scale = smallest_stretch(forward, shape.dimension)
        return scale if scale.is_constant else None

    def _scale_for_children(self, shape: Apply, place: Place) -> Expr | None:
        """The same, where the map may go on to the children besides."""
        return self._scale(shape, place) if self._is_pointwise(shape) else None

    def _is_pointwise(self, shape: Apply) -> bool:
        if not shape.children:
            return False
        key = (id(shape.definition), *(a if isinstance(a, Expr) else tuple(a) for a in shape.arguments))
        if key not in self._pointwise:
            self._pointwise[key] = is_pointwise(shape, self._values)
        return self._pointwise[key]

    def _uniform(self, scale: Expr, dimension: int) -> Matrix:
        return scaling(self._values, scale, scale, scale if dimension == 3 else 1.0)

    def _moved(self, inner: Shape, place: Place) -> Shape:
        forward, inverse = place
        return inner if _is_identity(forward) else self._graph.affine(forward, inverse, inner, inner.span)


def _is_identity(matrix: Matrix) -> bool:
    numbers = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    return all(e.is_constant and e.number == n for e, n in zip(matrix.entries, numbers, strict=True))


def _scaled(shape: Apply, scale: Expr) -> tuple[Argument, ...]:
    """The arguments, lengths times the scale."""
    if scale.number == 1.0:
        return shape.arguments
    pairs = zip(shape.definition.values, shape.arguments, strict=True)
    return tuple([_times(a, scale) if p.kind.is_length else a for p, a in pairs])


def _times(argument: Argument, scale: Expr) -> Argument:
    return tuple([e * scale for e in argument]) if isinstance(argument, tuple) else argument * scale
