"""Transforms are composed in float64 and carried to the leaves; uniform scales go into sizes."""

from __future__ import annotations

from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.definition import Argument
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union
from sdfc.shape.matrix import Matrix, identity, scaling
from sdfc.shape.stretch import is_similarity, smallest_stretch


def place(root: Shape, graph: ShapeGraph, values: FieldGraph) -> Shape:
    """Afterwards an Affine stands only directly on an Apply, and none is the identity. A uniform scale has gone into the
    lengths of every definition that is dimensionally consistent. Solids are the same sets; fields are the same where maps
    are similarities."""
    return _Placer(graph, values).placed(root, identity(values), identity(values))


class _Placer:
    def __init__(self, graph: ShapeGraph, values: FieldGraph) -> None:
        self._graph = graph
        self._values = values
        self._identity = identity(values)
        self._made: dict[tuple[object, ...], Shape] = {}

    def placed(self, shape: Shape, forward: Matrix, inverse: Matrix) -> Shape:
        key = (shape.id, forward.key)
        if key not in self._made:
            self._made[key] = self._place(shape, forward, inverse)
        return self._made[key]

    def _place(self, shape: Shape, forward: Matrix, inverse: Matrix) -> Shape:
        match shape:
            case Affine():
                return self.placed(shape.child, forward.after(shape.forward), shape.inverse.after(inverse))
            case Union() | Intersection():
                children = [self.placed(c, forward, inverse) for c in shape.children]
                return self._graph.with_children(shape, tuple(children))
            case Complement() | Paint():
                return self._graph.with_children(shape, (self.placed(shape.child, forward, inverse),))
            case Apply():
                return self._apply(shape, forward, inverse)
            case Nothing():
                return shape
            case _:
                assert_never(shape)

    def _apply(self, shape: Apply, forward: Matrix, inverse: Matrix) -> Shape:
        claims = shape.definition.claims
        similar = is_similarity(forward, shape.dimension)
        scale = smallest_stretch(forward, shape.dimension) if similar else None
        if scale is not None and claims.homogeneous and scale.is_constant:
            arguments = self._scaled(shape, scale)
            if claims.lowering is not None and not shape.definition.is_primitive:
                # the children are read at p itself: the map may go to them
                moved = [self.placed(c, forward, inverse) for c in shape.children]
                return self._graph.apply(shape.definition, arguments, moved, shape.span)
            if scale.number != 1.0 and shape.definition.is_primitive:
                shrink, grow = self._uniform(1.0 / scale, shape.dimension), self._uniform(scale, shape.dimension)
                forward, inverse = forward.after(shrink).tidied(), grow.after(inverse).tidied()
                return self._moved(self._graph.apply(shape.definition, arguments, (), shape.span), forward, inverse)
        children = [self.placed(c, self._identity, self._identity) for c in shape.children]
        inner = self._graph.apply(shape.definition, shape.arguments, children, shape.span)
        return self._moved(inner, forward, inverse)

    def _uniform(self, scale: Expr, dimension: int) -> Matrix:
        return scaling(self._values, scale, scale, scale if dimension == 3 else 1.0)

    def _moved(self, inner: Shape, forward: Matrix, inverse: Matrix) -> Shape:
        if forward.key == self._identity.key:
            return inner
        return self._graph.affine(forward, inverse, inner, inner.span)

    def _scaled(self, shape: Apply, scale: Expr) -> tuple[Argument, ...]:
        if scale.number == 1.0:
            return shape.arguments
        pairs = zip(shape.definition.values, shape.arguments, strict=True)
        return tuple(_times(a, scale) if p.kind.is_length else a for p, a in pairs)


def _times(argument: Argument, scale: Expr) -> Argument:
    return tuple(e * scale for e in argument) if isinstance(argument, tuple) else argument * scale
