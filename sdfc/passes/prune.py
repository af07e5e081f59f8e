"""Parts that boxes prove to be empty, or out of reach, are removed (ALGORITHMS C7, rules 3 to 5)."""

from __future__ import annotations

from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box
from sdfc.passes.rewrite import rewrite
from sdfc.shape.graph import Complement, Intersection, Nothing, Shape, ShapeGraph, Union


def prune(root: Shape, graph: ShapeGraph, bounds: Bounds) -> Shape:
    """Afterwards no intersection has parts whose boxes do not meet, and nothing is subtracted from where it is not. The
    zero set is the same; values far from it may be smaller."""
    return rewrite(root, graph, lambda shape: _pruned(shape, graph, bounds))


def _pruned(shape: Shape, graph: ShapeGraph, bounds: Bounds) -> Shape:
    match shape:
        case Intersection():
            box = bounds.box(shape)
            if box.is_empty:
                return graph.nothing(shape.span, shape.dimension)
            kept = [c for c in shape.children if not _out_of_reach(c, box, bounds)]
            return graph.with_children(shape, tuple(kept)) if len(kept) == len(shape.children) else _met(kept, shape, graph)
        case Union():
            kept = [c for c in shape.children if not bounds.box(c).is_empty]
            if len(kept) == len(shape.children):
                return shape
            return kept[0] if len(kept) == 1 else graph.union(kept, shape.span, shape.dimension)
        case _:
            return shape


def _met(kept: list[Shape], shape: Intersection, graph: ShapeGraph) -> Shape:
    return kept[0] if len(kept) == 1 else graph.intersection(kept, shape.span)


def _out_of_reach(shape: Shape, box: Box, bounds: Bounds) -> bool:
    match shape:
        case Complement(child=Nothing()):
            return True
        case Complement():
            return bounds.box(shape.child).meet(box).is_empty
        case _:
            return False
