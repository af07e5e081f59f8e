"""Nested unions and intersections become one; the empty solid and its complement disappear."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from sdfc.passes.rewrite import rewrite
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union


def flatten(root: Shape, graph: ShapeGraph) -> Shape:
    """Afterwards no union is a child of a union, no intersection of an intersection, no complement of a complement,
    each has two different children or more, and Nothing is at the root or nowhere (outside operations)."""
    return rewrite(root, graph, lambda shape: _flat(shape, graph))


def _is_everything(shape: Shape) -> bool:
    match shape:
        case Complement(child=Nothing()):
            return True
        case _:
            return False


def _flat(shape: Shape, graph: ShapeGraph) -> Shape:
    match shape:
        case Union():
            for child in shape.children:
                if _is_everything(child):
                    return child
            parts = _spliced(shape.children, Union)
            kept = [c for c in parts if not _is_nothing(c)]
            return _joined(kept, shape, graph)
        case Intersection():
            for child in shape.children:
                if _is_nothing(child):
                    return child
            parts = _spliced(shape.children, Intersection)
            kept = [c for c in parts if not _is_everything(c)]
            return _joined(kept, shape, graph) if kept else shape.children[0]
        case Complement():
            return _uncomplemented(shape)
        case Affine() | Paint():
            return shape.child if _is_nothing(shape.child) or _is_everything(shape.child) else shape
        case Apply() | Nothing():
            return shape
        case _:
            assert_never(shape)


def _uncomplemented(shape: Complement) -> Shape:
    match shape.child:
        case Complement(child=inner):
            return inner
        case _:
            return shape


def _is_nothing(shape: Shape) -> bool:
    match shape:
        case Nothing():
            return True
        case _:
            return False


def _spliced(children: Iterable[Shape], kind: type[Union] | type[Intersection]) -> list[Shape]:
    """Children of the same kind replaced by theirs; a part named twice stays once (a set algebra: a | a = a)."""
    parts: dict[int, Shape] = {}
    for child in children:
        for part in child.children if isinstance(child, kind) else (child,):
            parts.setdefault(part.id, part)
    return list(parts.values())


def _joined(parts: list[Shape], shape: Union | Intersection, graph: ShapeGraph) -> Shape:
    if not parts:
        return graph.nothing(shape.span, shape.dimension)
    if len(parts) == 1:
        return parts[0]
    if isinstance(shape, Union):
        return graph.union(parts, shape.span)
    return graph.intersection(parts, shape.span)
