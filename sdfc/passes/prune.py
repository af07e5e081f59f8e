"""Parts that boxes prove to be empty, or out of reach, are removed (ALGORITHMS C7, rules 1 and 3 to 5)."""

from __future__ import annotations

from typing import NamedTuple

from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box
from sdfc.field.graph import Expr
from sdfc.passes.flatten import is_nothing
from sdfc.passes.rewrite import descend
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Paint,
    Shape,
    ShapeGraph,
    Union,
)

# blends that are plain unions where their operands differ by the width or more (ALGORITHMS C2)
_COMPACT = ("smooth_union", "smooth_union_cubic", "smooth_union_circular")
_TOUCH = 1e-9  # of a box's radius: what rounding leaves between faces that coincide
_DEEPEST = 4  # blends in blends: each asks for the boxes of all below it at a level of its own


class _Reach(NamedTuple):
    """Up to which level a shape's values matter, and in how many blends it is. It is looked up with every shape."""

    level: float
    blends: int


def prune(root: Shape, graph: ShapeGraph, bounds: Bounds) -> Shape:
    """Afterwards no intersection has parts whose boxes do not meet, nothing is subtracted from where it is not, and no
    two parts are blended that are out of each other's reach. The zero set is the same; values inside may be smaller,
    and values far outside larger. What other operations are applied to is left alone: they may look at any value."""
    pruner = _Pruner(graph, bounds)
    start: _Reach | None = _Reach(0.0, 0)
    return descend(root, start, pruner.below, pruner.make)


class _Pruner:
    def __init__(self, graph: ShapeGraph, bounds: Bounds) -> None:
        self._graph = graph
        self._bounds = bounds

    def below(self, shape: Shape, reach: _Reach | None) -> list[tuple[Shape, _Reach | None]]:
        return [(c, self._handed_down(shape, reach)) for c in shape.children]

    def _handed_down(self, shape: Shape, reach: _Reach | None) -> _Reach | None:
        """How far the children's values matter; None where nothing is known of it."""
        match shape:
            case Union() | Intersection() | Paint():
                return reach
            case Affine():
                return reach if reach is not None and reach.level == 0.0 else None
            case Apply() if reach is not None and reach.blends < _DEEPEST:
                width = self._width(shape)
                return None if width is None else _Reach(reach.level + width, reach.blends + 1)
            case _:
                return None

    def _width(self, shape: Apply) -> float | None:
        """The greatest width of a compact blend: out of it, it is a union. None for anything else."""
        if shape.definition.name not in _COMPACT or not shape.definition.is_standard:
            return None
        (blend,) = shape.arguments
        assert isinstance(blend, Expr)
        return max(self._bounds.most(blend), 1e-9)  # as in the formula

    def make(self, shape: Shape, reach: _Reach | None, children: tuple[Shape, ...]) -> Shape:
        kept = self._graph.with_children(shape, children)
        if reach is None:
            return kept
        box = self._bounds.box(kept, reach.level)
        if box.is_empty or (reach.level == 0.0 and _only_touch(kept, box)):
            return self._graph.nothing(kept.span, kept.dimension)
        match kept:
            case Union():
                parts = [c for c in kept.children if not self._bounds.box(c, reach.level).is_empty]
                return self._joined(parts, kept)
            case Intersection():
                return self._joined(self._subtracted(kept, reach), kept)
            case Apply() if self._width(kept) is not None:
                return self._unblended(kept, reach)
            case _:
                return kept

    def _joined(self, parts: list[Shape], shape: Union | Intersection) -> Shape:
        if len(parts) == len(shape.children):
            return shape
        if len(parts) == 1:
            return parts[0]
        combine = self._graph.union if isinstance(shape, Union) else self._graph.intersection
        return combine(parts, shape.span)

    def _subtracted(self, shape: Intersection, reach: _Reach) -> list[Shape]:
        """The parts, without what is subtracted out of reach; one of them at least."""
        box = self._bounds.box(shape, reach.level)
        parts: list[Shape] = []
        for part in shape.children:
            match part:
                case Complement() if self._bounds.box(part.child).meet(box).is_empty:
                    pass
                case _:
                    parts.append(part)
        return parts or [self._graph.complement(self._graph.nothing(shape.span, shape.dimension), shape.span)]

    def _unblended(self, shape: Apply, reach: _Reach) -> Shape:
        """A union, where no point with a value up to the level has both operands within the width of the level."""
        width = self._width(shape)
        assert width is not None
        boxes = [self._bounds.box(c, reach.level + width) for c in shape.children]
        if boxes[0].meet(boxes[1]).is_empty:
            near = [c for c, box in zip(shape.children, boxes, strict=True) if not (is_nothing(c) or box.is_empty)]
            return near[0] if len(near) == 1 else self._graph.union(near, shape.span, shape.dimension)
        return shape


def _only_touch(shape: Shape, box: Box) -> bool:
    """Whether an intersection is no more than the face of two solids that touch: a solid of no thickness is nothing."""
    match shape:
        case Intersection():
            return box.is_finite and min(box.half) <= _TOUCH * box.radius
        case _:
            return False
