"""Complements go to the leaves (De Morgan)."""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from sdfc.passes.rewrite import rewrite
from sdfc.shape.definition import Definition
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union

Lookup = Callable[[str], Definition | None]


def negate(root: Shape, graph: ShapeGraph, definition: Lookup) -> Shape:
    """Afterwards a Complement stands only on a leaf: a primitive or an operation without a dual, placed and painted or
    not. `definition` finds the dual of a blend by name."""
    negator = _Negator(graph, definition)
    return rewrite(root, graph, negator.change)


class _Negator:
    def __init__(self, graph: ShapeGraph, definition: Lookup) -> None:
        self._graph = graph
        self._definition = definition
        self._made: dict[int, Shape] = {}

    def change(self, shape: Shape) -> Shape:
        match shape:
            case Complement():
                return self.negated(shape.child)
            case _:
                return shape

    def negated(self, shape: Shape) -> Shape:
        if shape.id not in self._made:
            self._made[shape.id] = self._negate(shape)
        return self._made[shape.id]

    def _negate(self, shape: Shape) -> Shape:
        match shape:
            case Complement():
                return shape.child
            case Union():
                return self._graph.intersection([self.negated(c) for c in shape.children], shape.span)
            case Intersection():
                return self._graph.union([self.negated(c) for c in shape.children], shape.span)
            case Apply() if shape.definition.claims.dual is not None:
                dual = self._definition(shape.definition.claims.dual)
                assert dual is not None, f"the dual of {shape.definition.name} is not defined"
                return self._graph.apply(dual, shape.arguments, [self.negated(c) for c in shape.children], shape.span)
            case Apply() | Affine() | Paint() | Nothing():
                return self._graph.complement(shape, shape.span)
            case _:
                assert_never(shape)
