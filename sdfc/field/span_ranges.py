"""Ranges of numbers whose ends are field expressions: interval arithmetic that is printed, folded and shared.

The twin of `interval_rules`, which computes where this writes down. Rounding: float32's is about 2^-24 of the numbers
that meet. A decision (which side of a kink, which cell, which quarter of a wave) is taken with `slack` to spare, which
is 2^-21 of the coordinates' magnitudes, and counts as open within it; ends are not widened operation by operation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from sdfc.field.graph import Expr, FieldGraph, Op

HUGE = 1e9  # stands for infinity: its cube is a float32, and 0 times it is 0
TINY = 1e-9  # nothing is divided by less
TWO_PI = 2.0 * math.pi


class Range(NamedTuple):
    """[lo, hi] of a FLOAT; of a BOOL: whether it is certainly, and whether it is possibly true."""

    lo: Expr
    hi: Expr

    @property
    def is_point(self) -> bool:
        return self.lo is self.hi


def point(value: Expr) -> Range:
    """The range of one number."""
    return Range(value, value)


def is_at_least(value: Expr, least: float) -> bool:
    """Whether the expression is a constant of at least that."""
    return value.is_constant and value.number >= least


class Ranges:
    """Arithmetic of ranges in one graph; `slack` is what a decision must have to spare."""

    def __init__(self, graph: FieldGraph, slack: Expr) -> None:
        self.graph = graph
        self.slack = slack

    def constant(self, lo: float, hi: float) -> Range:
        return Range(self.graph.constant(lo), self.graph.constant(hi))

    def hull(self, a: Range, b: Range) -> Range:
        return Range(self.graph.min(a.lo, b.lo), self.graph.max(a.hi, b.hi))

    def added(self, a: Range, b: Range) -> Range:
        return Range(a.lo + b.lo, a.hi + b.hi)

    def subtracted(self, a: Range, b: Range) -> Range:
        return Range(a.lo - b.hi, a.hi - b.lo)

    def negated(self, a: Range) -> Range:
        return Range(-a.hi, -a.lo)

    def sum(self, ranges: Sequence[Range]) -> Range:
        total = ranges[0]
        for other in ranges[1:]:
            total = self.added(total, other)
        return total

    def multiplied(self, a: Range, b: Range, a_positive: bool = False, b_positive: bool = False) -> Range:
        """a * b. `positive` says that a factor is never below 0: two corners are then enough for each end."""
        g = self.graph
        if a.is_point or (b_positive and not a_positive and not b.is_point):
            a, b, a_positive, b_positive = b, a, b_positive, a_positive
        if b.is_point:
            return self._scaled(a, b.lo, b_positive)
        if a_positive and b_positive:
            return Range(a.lo * b.lo, a.hi * b.hi)
        if a_positive:
            return Range(g.min(a.lo * b.lo, a.hi * b.lo), g.max(a.lo * b.hi, a.hi * b.hi))
        corners = [x * y for x in a for y in b]
        return Range(self._least(corners), self._most(corners))

    def _scaled(self, a: Range, factor: Expr, positive: bool) -> Range:
        if a.is_point:
            return point(a.lo * factor)
        if positive or is_at_least(factor, 0.0):
            return Range(a.lo * factor, a.hi * factor)
        if factor.is_constant:
            return Range(a.hi * factor, a.lo * factor)
        first, second = a.lo * factor, a.hi * factor
        return Range(self.graph.min(first, second), self.graph.max(first, second))

    def _least(self, values: Sequence[Expr]) -> Expr:
        a, b, c, d = values
        return self.graph.min(self.graph.min(a, b), self.graph.min(c, d))

    def _most(self, values: Sequence[Expr]) -> Expr:
        a, b, c, d = values
        return self.graph.max(self.graph.max(a, b), self.graph.max(c, d))

    def magnitude(self, a: Range) -> Range:
        """|a|."""
        g = self.graph
        if a.is_point:
            return point(g.abs(a.lo))
        return Range(g.max(g.max(a.lo, -a.hi), 0.0), g.max(-a.lo, a.hi))

    def squared(self, a: Range) -> Range:
        size = self.magnitude(a)
        return Range(size.lo * size.lo, size.hi * size.hi)

    def reciprocal(self, b: Range, positive: bool = False) -> Range:
        """1 / b; everything where b may be 0."""
        g = self.graph
        if b.is_point:
            return point(1.0 / b.lo)
        if positive:
            return Range(1.0 / g.max(b.hi, TINY), 1.0 / g.max(b.lo, TINY))
        safe = g.call(Op.OR, self.slack < b.lo, b.hi < -self.slack)
        return Range(g.select(safe, 1.0 / b.hi, -HUGE), g.select(safe, 1.0 / b.lo, HUGE))

    def root(self, a: Range) -> Range:
        g = self.graph
        return Range(g.sqrt(g.max(a.lo, 0.0)), g.sqrt(g.max(a.hi, 0.0)))

    def clipped(self, a: Range, limit: Expr) -> Range:
        """What of a lies in [-limit, limit]."""
        return Range(self.graph.max(a.lo, -limit), self.graph.min(a.hi, limit))

    def increasing(self, op: Op, a: Range) -> Range:
        """An increasing function of one argument."""
        return Range(self.graph.call(op, a.lo), self.graph.call(op, a.hi))

    def wave(self, op: Op, a: Range) -> Range:
        """sin or cos: the ends, or 1 and -1 where a peak or a trough lies between."""
        g = self.graph
        peak = 0.25 if op is Op.SIN else 0.0
        first, second = g.call(op, a.lo), g.call(op, a.hi)
        if a.is_point:
            return point(first)
        lo, hi = (a.lo - self.slack) * (1.0 / TWO_PI), (a.hi + self.slack) * (1.0 / TWO_PI)

        def has(turn: float) -> Expr:
            return lo - turn <= g.call(Op.FLOOR, hi - turn)

        return Range(
            g.select(has(peak + 0.5), -1.0, g.min(first, second)), g.select(has(peak), 1.0, g.max(first, second))
        )

    def less(self, difference: Range, strict: bool) -> Range:
        """a < b or a <= b, of the range of a - b."""
        certain = difference.hi < -self.slack
        impossible = self.slack <= difference.lo if strict else self.slack < difference.lo
        return Range(certain, self.graph.call(Op.NOT, impossible))  # so that NaN is possible, and nothing is certain

    def chosen(self, first: Expr, second: Expr, a: Range, b: Range) -> Range:
        """a where `first` holds, b where `second` does, else the hull of both."""
        both = self.hull(a, b)
        if a.lo is b.lo and a.hi is b.hi:
            return a
        return Range(
            self.graph.select(first, a.lo, self.graph.select(second, b.lo, both.lo)),
            self.graph.select(first, a.hi, self.graph.select(second, b.hi, both.hi)),
        )
