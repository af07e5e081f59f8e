"""Nested unions and intersections become one; the empty solid and its complement disappear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

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
    topological,
)


def flatten(root: Shape, graph: ShapeGraph) -> Shape:
    """Afterwards no union is a child of a union, no intersection of an intersection, no complement of a complement,
    each has two different children or more, and Nothing (or its complement) is at the root, in an operation or
    nowhere."""
    made: dict[int, Shape] = {}
    needed = _needed(root)
    for shape in topological(root):
        if shape.id in needed:
            made[shape.id] = _flat(shape, made, graph)
    return made[root.id]


def _needed(root: Shape) -> set[int]:
    """The nodes that do not merely disappear in a parent of their own kind: chains are as long as scenes are."""
    needed = {root.id}
    for shape in topological(root):
        match shape:
            case Union() | Intersection():
                needed.update(c.id for c in shape.children if type(c) is not type(shape))
            case _:
                needed.update(c.id for c in shape.children)
    return needed


def _flat(shape: Shape, made: dict[int, Shape], graph: ShapeGraph) -> Shape:
    match shape:
        case Union():
            parts = _spliced(shape, made)
            everything = [part for part in parts if is_everything(part)]
            kept = [part for part in parts if not is_nothing(part)]
            if everything or len(kept) < 2:
                return (everything or kept or parts)[0]
            return graph.union(kept, shape.span)
        case Intersection():
            parts = _spliced(shape, made)
            empty = [part for part in parts if is_nothing(part)]
            kept = [part for part in parts if not is_everything(part)]
            if empty or len(kept) < 2:
                return (empty or kept or parts)[0]
            return graph.intersection(kept, shape.span)
        case Complement():
            return _uncomplemented(made[shape.child.id], shape, graph)
        case Affine() | Paint():
            child = made[shape.child.id]
            return child if is_nothing(child) or is_everything(child) else graph.with_children(shape, (child,))
        case Apply():
            return graph.with_children(shape, tuple([made[c.id] for c in shape.children]))
        case Nothing():
            return shape
        case _:
            assert_never(shape)


def _spliced(shape: Union | Intersection, made: dict[int, Shape]) -> Sequence[Shape]:
    """The parts of a nest of one kind, in order; a part named twice stays once (a set algebra: a | a = a)."""
    kind = type(shape)
    parts: dict[int, Shape] = {}
    seen: set[int] = set()
    stack: list[Shape] = [shape]
    while stack:
        node = stack.pop()
        if node.id in seen:
            continue
        seen.add(node.id)
        flat = made.get(node.id, node)  # what is not made is of the nest
        if isinstance(flat, kind):
            stack.extend(reversed(flat.children))
        else:
            parts.setdefault(flat.id, flat)
    return list(parts.values())


def _uncomplemented(child: Shape, shape: Complement, graph: ShapeGraph) -> Shape:
    match child:
        case Complement(child=inner):
            return inner
        case _:
            return graph.with_children(shape, (child,))


def is_nothing(shape: Shape) -> bool:
    """Whether it is the empty solid."""
    match shape:
        case Nothing():
            return True
        case _:
            return False


def is_everything(shape: Shape) -> bool:
    """Whether it is the complement of the empty solid."""
    match shape:
        case Complement(child=Nothing()):
            return True
        case _:
            return False
