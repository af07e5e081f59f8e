"""Complements go to the leaves (De Morgan)."""

from __future__ import annotations

from collections.abc import Callable

from sdfc.passes.rewrite import descend
from sdfc.shape.definition import Definition
from sdfc.shape.graph import Apply, Complement, Intersection, Shape, ShapeGraph, Union

Lookup = Callable[[str], Definition | None]


def negate(root: Shape, graph: ShapeGraph, definition: Lookup) -> Shape:
    """Afterwards a Complement stands only on a leaf: a primitive or an operation without a dual, placed and painted or
    not, or Nothing. `definition` finds the dual of a blend by name."""

    def below(shape: Shape, negative: bool) -> list[tuple[Shape, bool]]:
        match shape:
            case Complement():
                return [(shape.child, not negative)]
            case Union() | Intersection():
                return [(c, negative) for c in shape.children]
            case _:
                inner = negative and _dual(shape, definition) is not None
                return [(c, inner) for c in shape.children]

    def make(shape: Shape, negative: bool, children: tuple[Shape, ...]) -> Shape:
        match shape:
            case Complement():
                return children[0]
            case Union() if negative:
                return graph.intersection(children, shape.span)
            case Intersection() if negative:
                return graph.union(children, shape.span)
            case Apply() if negative:
                dual = _dual(shape, definition)
                if dual is not None:
                    return graph.apply(dual, shape.arguments, children, shape.span)
            case _:
                pass
        kept = graph.with_children(shape, children)
        return graph.complement(kept, shape.span) if negative else kept

    return descend(root, False, below, make)


def _dual(shape: Shape, definition: Lookup) -> Definition | None:
    match shape:
        case Apply():
            dual = shape.definition.claims.dual
            return None if dual is None else definition(dual)
        case _:
            return None
