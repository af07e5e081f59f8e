"""The level box: a box that holds {f <= level}, for every value of the params (ALGORITHMS C6)."""

from __future__ import annotations

import math
from typing import assert_never

from sdfc.facts.box import Box, everything, nothing
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.definition import ChildFacts, Exactness
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, children_of
from sdfc.shape.matrix import Matrix
from sdfc.shape.stretch import smallest_stretch

_EXACT_OUTSIDE = (Exactness.EXACT, Exactness.EXACT_OUTSIDE)


class Bounds:
    """Boxes by shape and level. Walks without recursion: scenes are thousands of nodes deep."""

    def __init__(self, ranges: Ranges) -> None:
        self._ranges = ranges
        self._boxes: dict[tuple[int, float], Box] = {}

    def box(self, shape: Shape, level: float = 0.0) -> Box:
        stack: list[tuple[Shape, float]] = [(shape, level)]
        while stack:
            node, at = stack[-1]
            if (node.id, at) in self._boxes:
                stack.pop()
                continue
            child_level = self._child_level(node, at)
            waiting = [c for c in children_of(node) if (c.id, child_level) not in self._boxes]
            if waiting:
                stack.extend((c, child_level) for c in waiting)
            else:
                boxes = [self._boxes[c.id, child_level] for c in children_of(node)]
                self._boxes[node.id, at] = self._box(node, at, boxes)
                stack.pop()
        return self._boxes[shape.id, level]

    def _child_level(self, node: Shape, level: float) -> float:
        match node:
            case Apply():
                lowering = node.definition.claims.lowering
                return level + (self._ranges.interval(lowering(node.environment))[1] if lowering else 0.0)
            case Affine():
                if level == 0.0:
                    return 0.0
                smallest = self._ranges.interval(smallest_stretch(node.forward, node.dimension))[0]
                return level / smallest if smallest > 0 else math.inf
            case Complement():
                return 0.0  # not asked of the child: a complement is unbounded whatever it is
            case Union() | Intersection() | Paint() | Nothing():
                return level
            case _:
                assert_never(node)

    def _box(self, node: Shape, level: float, boxes: list[Box]) -> Box:
        match node:
            case Apply():
                return self._apply(node, level, boxes)
            case Affine():
                return self.moved(node.forward, boxes[0])
            case Union():
                result = nothing(node.dimension)
                for box in boxes:
                    result = result.hull(box)
                return result
            case Intersection():
                result = everything(node.dimension)
                for box in boxes:
                    result = result.meet(box)
                return result
            case Complement():
                return everything(node.dimension)
            case Paint():
                return boxes[0]
            case Nothing():
                return nothing(node.dimension)
            case _:
                assert_never(node)

    def moved(self, matrix: Matrix, box: Box) -> Box:
        """The box of the image, for every value of the params."""
        if matrix.is_constant:
            rows = [[e.number for e in row] for row in matrix.linear]
            return box.moved(rows, [e.number for e in matrix.offset])
        if not box.is_finite:
            return box if box.is_empty else everything(len(box.lo))
        entries_lo, entries_hi = self._ranges.bounds(matrix.entries)
        return _turned(entries_lo, entries_hi, box)

    def _apply(self, node: Apply, level: float, boxes: list[Box]) -> Box:
        claims = node.definition.claims
        if any(b.is_empty for b in boxes) and len(boxes) == 1:
            return boxes[0]
        if claims.bounds is None:
            if claims.lowering is not None and boxes:
                result = boxes[0]
                for box in boxes[1:]:
                    result = result.hull(box)
                return result
            return everything(node.dimension)
        graph = _graph_of(node)
        lo, hi = claims.bounds(node.environment, child_facts(graph, node, boxes), graph.constant(level))
        lows, highs = self._ranges.bounds([lo])[0], self._ranges.bounds([hi])[1]
        size = node.dimension
        box = Box(_spread(lows, size), _spread(highs, size))
        if node.definition.is_primitive and not claims.bounds_use_level and level > 0.0:
            return box.widened(level) if claims.exactness in _EXACT_OUTSIDE else everything(size)
        return box


def _spread(numbers: list[float], size: int) -> tuple[float, ...]:
    return tuple(numbers) if len(numbers) == size else tuple(numbers[:1]) * size


def _graph_of(node: Apply) -> FieldGraph:
    for argument in node.arguments:
        first = argument[0] if isinstance(argument, tuple) else argument
        return first.graph
    for child in node.children:
        stack = [child]
        while stack:
            shape = stack.pop()
            match shape:
                case Apply() if shape.arguments:
                    return _graph_of(shape)
                case Affine():
                    return shape.forward.offset[0].graph
                case _:
                    stack.extend(children_of(shape))
    return FieldGraph()


def child_facts(
    graph: FieldGraph, node: Apply, boxes: list[Box], lipschitz: list[float] | None = None
) -> dict[str, ChildFacts]:
    """What the node's claims may ask of its children."""
    slopes = lipschitz or [1.0] * len(boxes)

    def facts(box: Box, slope: float) -> ChildFacts:
        return ChildFacts(_constant(graph, box.lo), _constant(graph, box.hi), graph.constant(slope))

    names = [p.name for p in node.definition.children]
    return {n: facts(b, s) for n, b, s in zip(names, boxes, slopes, strict=True)}


def _constant(graph: FieldGraph, numbers: tuple[float, ...]) -> Expr:
    return graph.constant(*numbers)


def _turned(lo: list[float], hi: list[float], box: Box) -> Box:
    """The box of all images under matrices whose entries lie between lo and hi (rows of the linear part, then offset)."""
    size = len(box.lo)
    low, high = [], []
    for i in range(size):
        a = b = 0.0
        for j in range(size):
            ends = [k * x for k in (lo[3 * i + j], hi[3 * i + j]) for x in (box.lo[j], box.hi[j])]
            a, b = a + min(ends), b + max(ends)
        low.append(a + lo[9 + i])
        high.append(b + hi[9 + i])
    return Box(tuple(low), tuple(high))
