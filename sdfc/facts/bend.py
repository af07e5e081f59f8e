"""How hard a part's field bends down: what a parabola below it is made of (the second order of ALGORITHMS B3)."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box, everything
from sdfc.facts.curvature import convex_shapes
from sdfc.facts.lipschitz import Lipschitz
from sdfc.facts.ranges import Range, Ranges
from sdfc.field.core import signed_core
from sdfc.field.graph import Expr, FieldGraph, Op, Type, params_of
from sdfc.shape.graph import Apply, Shape
from sdfc.shape.lower import Lowering

_ROUNDING = 1.0 + 1e-5


class Bends:
    """Bounds by shape and box, in the shape's own space."""

    def __init__(self, ranges: Ranges, bounds: Bounds, lipschitz: Lipschitz) -> None:
        self._ranges = ranges
        self._bounds = bounds
        self._lipschitz = lipschitz
        self._found: dict[tuple[int, Box], Expr | None] = {}

    def bound(self, shape: Apply, region: Box) -> Expr | None:
        """K: along lines of unit speed the core falls no faster than f + f' x - K x x / 2, while it is above -DEEP.

        None where no bound is known. Where params are live, K goes by their values: a step for each piece of a range.
        """
        if not region.is_finite:
            return None
        key = (shape.id, region)
        if key not in self._found:
            self._found[key] = self._bound(shape, region)
        return self._found[key]

    def _bound(self, shape: Apply, region: Box) -> Expr | None:
        from sdfc.field.bend import bend_bounds

        graph = self._bounds.values
        lowering = _Recording(self._lipschitz, convex_shapes(shape))
        root = core_of(shape, lowering.value(shape, graph.input("p", Type(shape.dimension))))
        pieces = self._ranges.pieces(params_of([root]))
        whole = [self._ranges.of] if len(pieces) > 1 else []
        bounds = bend_bounds(root, region.lo, region.hi, [*pieces, *whole], lowering.convex)
        if not all(map(math.isfinite, bounds[: len(pieces)])):
            return None
        if not whole:
            return graph.constant(bounds[0] * _ROUNDING)
        result = bounds.pop()
        chosen = graph.constant(result * _ROUNDING if math.isfinite(result) else 1e9)
        live = [name for name in params_of([root]) if self._ranges.of[name][0] != self._ranges.of[name][1]]
        for piece, bound in zip(pieces, bounds, strict=True):
            chosen = graph.select(_lies_in(graph, {n: piece[n] for n in sorted(live)}), bound * _ROUNDING, chosen)
        return chosen


def core_of(shape: Apply, value: Expr) -> Expr:
    """What a parabola is put under: the core of an operation's formula; a primitive's is shared over its arguments."""
    return value if shape.definition.is_primitive else signed_core(value)


class _Recording(Lowering):
    """Notes which values are convex functions of the point that they were asked at, and how steep."""

    def __init__(self, lipschitz: Lipschitz, shapes: frozenset[int]) -> None:
        super().__init__()
        self._lipschitz = lipschitz
        self._shapes = shapes
        self.convex: dict[int, tuple[Expr, float]] = {}

    def value(self, shape: Shape, p: Expr) -> Expr:
        result = super().value(shape, p)
        if shape.id in self._shapes and self._lipschitz.is_global(shape):
            steep = self._lipschitz.constant(shape, everything(shape.dimension))
            self.convex[result.id] = (p, steep)
        return result


def _lies_in(graph: FieldGraph, piece: Mapping[str, Range]) -> Expr:
    """Whether the params have values in these ranges."""
    inside = graph.boolean(True)
    for name, (lo, hi) in piece.items():
        param = graph.param(name, Type(len(lo)))
        for i, (low, high) in enumerate(zip(lo, hi, strict=True)):
            component = param if len(lo) == 1 else param[i]
            both = graph.call(Op.AND, graph.constant(low) <= component, component <= high)
            inside = graph.call(Op.AND, inside, both)
    return inside
