"""Which material is seen at a point of an operation's surface: an index, as an expression of the point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from sdfc.field.graph import Expr
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.lower import Lowering
from sdfc.shape.material import Material

Candidate = tuple[Expr, Expr]  # a part's value, and the index of its material, at a point


class Looks:
    """Lowers the choice of a material: the part that decides the value decides the look."""

    def __init__(self, lowering: Lowering, materials: Sequence[Material], unpainted: Material) -> None:
        self._lowering = lowering
        self._index = {id(material): float(i) for i, material in enumerate(materials)}
        self._unpainted = self._index.get(id(unpainted), 0.0)
        self._made: dict[tuple[int, int], Expr] = {}

    def index(self, shape: Shape, p: Expr) -> Expr:
        """The index (FLOAT) of the material of `shape` at `p`."""
        key = (shape.id, p.id)
        if key not in self._made:
            self._made[key] = self._lowered(shape, p)
        return self._made[key]

    def _lowered(self, shape: Shape, p: Expr) -> Expr:
        match shape:
            case Paint():
                return p.graph.constant(self._index[id(shape.material)])
            case Affine():
                return self.index(shape.child, shape.inverse.apply(p))
            case Complement():
                return self.index(shape.child, p)
            case Union():
                return _chosen([self._candidate(c, p) for c in shape.children], least=True)
            case Intersection():
                return _chosen([self._candidate(c, p) for c in shape.children], least=False)
            case Apply():
                return self._applied(shape, p)
            case Nothing():
                return p.graph.constant(self._unpainted)
            case _:
                assert_never(shape)

    def _candidate(self, shape: Shape, p: Expr) -> Candidate:
        return self._lowering.value(shape, p), self.index(shape, p)

    def _applied(self, shape: Apply, p: Expr) -> Expr:
        """An operation shows its child as it is at the point where the formula reads it."""
        read: list[Candidate] = []

        def watched(child: Shape) -> Callable[[Expr], Expr]:
            def at(q: Expr) -> Expr:
                read.append(self._candidate(child, q))
                return self._lowering.value(child, q)

            return at

        names = [parameter.name for parameter in shape.definition.children]
        children = {name: watched(child) for name, child in zip(names, shape.children, strict=True)}
        shape.definition.formula(p, shape.environment, children)
        if not read:
            return p.graph.constant(self._unpainted)
        return _chosen(read, least="intersection" not in shape.definition.name)


def _chosen(candidates: Sequence[Candidate], least: bool) -> Expr:
    value, index = candidates[0]
    graph = value.graph
    for other, other_index in candidates[1:]:
        nearer = other < value if least else value < other
        index = graph.select(nearer, other_index, index)
        value = graph.min(value, other) if least else graph.max(value, other)
    return index
