"""The level box: a box that holds {f <= level}, for every value of the params (ALGORITHMS C6)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import assert_never

from sdfc.facts.box import Box, everything, hull, meeting, nothing
from sdfc.facts.claimed import claimed_corners
from sdfc.facts.enclosure import enclosing
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.shape.definition import ChildFacts, Claims, Exactness
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.lower import lower
from sdfc.shape.matrix import Matrix
from sdfc.shape.stretch import smallest_stretch

_EXACT_OUTSIDE = (Exactness.EXACT, Exactness.EXACT_OUTSIDE)
_FARTHEST = 1e15


class Bounds:
    """Boxes by shape and level. Walks without recursion: scenes are thousands of nodes deep."""

    def __init__(self, values: FieldGraph, ranges: Ranges) -> None:
        self.values = values
        self._ranges = ranges
        self._boxes: dict[tuple[Shape, float], Box] = {}
        self._lowerings: dict[int, float] = {}
        self._stretches: dict[int, tuple[float, float]] = {}

    def box(self, shape: Shape, level: float = 0.0) -> Box:
        """A box that holds every point where the shape's field is `level` or less; of the shape's own dimension."""
        boxes = self._boxes
        stack = [(shape, level)]
        while (shape, level) not in boxes:
            node, at = asking = stack.pop()
            if asking in boxes:
                continue
            children, below = self._asked(node, at)
            known = [box for child in children if (box := boxes.get((child, below))) is not None]
            if len(known) == len(children):
                boxes[asking] = _usable(self._box(node, at, known))
            else:
                stack.append(asking)
                stack += [(child, below) for child in children]
        return boxes[shape, level]

    def moved(self, matrix: Matrix, box: Box) -> Box:
        """The box of the image, for every value of the params."""
        if matrix.numbers is not None:
            return box.moved(matrix.numbers)
        if not box.is_finite:
            return box if box.is_empty else everything(len(box.lo))
        entries_lo, entries_hi = self._ranges.bounds(matrix.entries)
        return _turned(entries_lo, entries_hi, box)

    def _asked(self, node: Shape, level: float) -> tuple[Sequence[Shape], float]:
        """The children whose boxes the node's box is made of, and at which level."""
        match node:
            case Apply():
                return node.children, level + self._lowering(node)
            case Affine():
                return (node.child,), self._unstretched(node, level)
            case Union() | Intersection():
                return node.children, level
            case Paint():
                return (node.child,), level
            case Complement() | Nothing():
                return (), level  # a complement is taken to be unbounded, whatever it is of
            case _:
                assert_never(node)

    def most(self, value: Expr) -> float:
        """The greatest value of a FLOAT that a param may change; infinite where it is not known."""
        high = self._ranges.interval(value)[1]
        return math.inf if math.isnan(high) else high

    def _lowering(self, node: Apply) -> float:
        """How far below its children's the node's values may lie."""
        claim = node.definition.claims.lowering
        if claim is None:
            return 0.0
        if node.id not in self._lowerings:
            self._lowerings[node.id] = self.most(claim(node.environment))
        return self._lowerings[node.id]

    def _unstretched(self, node: Affine, level: float) -> float:
        """The child's level: the field is the child's times the smallest stretch."""
        if level == 0.0:
            return 0.0
        if node.id not in self._stretches:
            self._stretches[node.id] = self._ranges.interval(smallest_stretch(node.forward, node.dimension))
        least, most = self._stretches[node.id]
        stretch = least if level > 0 else most
        return level / stretch if stretch > 0 else math.inf  # also where it is not a number

    def _box(self, node: Shape, level: float, boxes: list[Box]) -> Box:
        match node:
            case Apply():
                return self._apply(node, level, boxes)
            case Affine():
                return self.moved(node.forward, boxes[0])
            case Union():
                return hull(boxes)
            case Intersection():
                return meeting(boxes)
            case Complement():
                return everything(node.dimension)
            case Paint():
                return boxes[0]
            case Nothing():
                return nothing(node.dimension)
            case _:
                assert_never(node)

    def _apply(self, node: Apply, level: float, boxes: list[Box]) -> Box:
        definition, size = node.definition, node.dimension
        claims = definition.claims
        if level == math.inf:
            return everything(size)
        if definition.is_standard and boxes and level <= 0.0 and all(b.is_empty for b in boxes):
            return nothing(size)
        if claims.bounds is None:  # what says how far it lowers its children does not move them
            return hull(boxes) if claims.lowering is not None and boxes else self._enclosed(node, level)
        if level > 0.0 and not claims.bounds_use_level and not (definition.is_standard and boxes):
            return self._widened(node, claims, level, boxes)
        return self._claimed(node, level, boxes)

    def _widened(self, node: Apply, claims: Claims, level: float, boxes: list[Box]) -> Box:
        """Where the claim is of level 0: its author need not have thought of others."""
        if claims.lowering is not None and boxes:
            return hull(boxes)
        if claims.exactness in _EXACT_OUTSIDE and not boxes:
            return self._claimed(node, level, boxes).widened(level)
        return self._enclosed(node, level)

    def _enclosed(self, node: Apply, level: float) -> Box:
        """What intervals say of a formula that a user wrote; of no operation, since nests of them are long."""
        if node.children or node.definition.is_standard:
            return everything(node.dimension)
        p = self.values.input("p", Type(node.dimension))
        return enclosing(lower(node, p), node.dimension, level, self._ranges)

    def _claimed(self, node: Apply, level: float, boxes: list[Box]) -> Box:
        corners = claimed_corners(node, level, self.values)
        if corners is not None:
            return _box_of(*corners)
        bounds = node.definition.claims.bounds
        assert bounds is not None
        lo, hi = bounds(node.environment, child_facts(self.values, node, boxes), self.values.constant(level))
        lows, highs = self._ranges.bounds([lo])[0], self._ranges.bounds([hi])[1]
        return _box_of(lows, highs)


def _usable(box: Box) -> Box:
    """Without bounds beyond what float32 can square: nests of turned boxes double without end."""
    for a, b in zip(box.lo, box.hi, strict=True):
        if not (a >= -_FARTHEST and b <= _FARTHEST):
            return _clipped(box)
    return box


def _clipped(box: Box) -> Box:
    return Box(
        tuple([a if a >= -_FARTHEST else -math.inf for a in box.lo]),
        tuple([b if b <= _FARTHEST else math.inf for b in box.hi]),
    )


def child_facts(
    graph: FieldGraph, node: Apply, boxes: Sequence[Box], lipschitz: Sequence[float] = ()
) -> dict[str, ChildFacts]:
    """What the node's claims may ask of its children."""
    slopes = lipschitz or [1.0] * len(boxes)
    facts = [
        ChildFacts(graph.constant(*box.lo), graph.constant(*box.hi), graph.constant(slope))
        for box, slope in zip(boxes, slopes, strict=True)
    ]
    return {p.name: f for p, f in zip(node.definition.children, facts, strict=True)}


def _turned(lo: list[float], hi: list[float], box: Box) -> Box:
    """The box of all images under matrices with entries between lo and hi (rows of the linear part, then offset)."""
    size = len(box.lo)
    low, high = [], []
    for i in range(size):
        a = b = 0.0
        for j in range(size):
            ends = [k * x for k in (lo[3 * i + j], hi[3 * i + j]) for x in (box.lo[j], box.hi[j])]
            # an entry without bound times a corner at 0
            is_unknown = any(map(math.isnan, ends))
            a, b = (-math.inf, math.inf) if is_unknown else (a + min(ends), b + max(ends))
        low.append(a + lo[9 + i])
        high.append(b + hi[9 + i])
    return _box_of(low, high)


def _box_of(lo: Sequence[float], hi: Sequence[float]) -> Box:
    """The box, without a bound where a number is none."""
    return Box(
        tuple([-math.inf if math.isnan(x) else x for x in lo]),
        tuple([math.inf if math.isnan(x) else x for x in hi]),
    )
