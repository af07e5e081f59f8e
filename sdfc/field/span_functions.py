"""Functions, steps, powers and angles of tracks: where `span_rules` has formulas of an operation's own."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from functools import reduce
from typing import TypeAlias

from sdfc.field.graph import Expr, Op
from sdfc.field.span_ranges import HUGE, Range, point
from sdfc.field.span_walk import Bend, Track, Walk

# (walk, value and rise at the start, arguments) -> the track of one component
Component: TypeAlias = Callable[[Walk, Expr, Expr, Sequence[Track]], Track]

_LARGEST_POWER = 64
_PI = 3.141592653589793


# ---- functions of one argument


def increasing(derivative: Callable[[Walk, Track, Range], Range], positive: bool) -> Callable[[Op], Component]:
    """A smooth increasing function, whose derivative is `derivative` of the argument and the function's range.

    `positive` says that the function's own values are never below 0.
    """

    def of(op: Op) -> Component:
        def rule(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
            (a,) = args
            value = walk.ranges.root(a.value) if op is Op.SQRT else walk.ranges.increasing(op, a.value)
            slope = walk.ranges.multiplied(derivative(walk, a, value), walk.moving(a), a_positive=True)
            return Track(value, slope, here, rise, Bend.UNKNOWN, positive)

        return rule

    return of


def _half_over(walk: Walk, a: Track, value: Range) -> Range:
    return walk.ranges.reciprocal(Range(2.0 * value.lo, 2.0 * value.hi), positive=True)


def _over_squares(walk: Walk, a: Track, value: Range) -> Range:
    square = walk.ranges.squared(a.value)
    return walk.ranges.reciprocal(Range(1.0 + square.lo, 1.0 + square.hi), positive=True)


def _over(walk: Walk, a: Track, value: Range) -> Range:
    return walk.ranges.reciprocal(a.value, positive=True)


def _over_root(walk: Walk, a: Track, value: Range) -> Range:
    """1 / sqrt(1 - a a), of an arc sine."""
    square = walk.ranges.squared(a.value)
    return walk.ranges.reciprocal(walk.ranges.root(Range(1.0 - square.hi, 1.0 - square.lo)), positive=True)


def arc(op: Op) -> Component:
    """asin or acos of what is clipped to [-1, 1]."""

    def rule(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
        (a,) = args
        g, ranges = walk.graph, walk.ranges
        inside = Range(g.clamp(a.value.lo, -1.0, 1.0), g.clamp(a.value.hi, -1.0, 1.0))
        value = ranges.increasing(op, inside)
        slope = ranges.multiplied(_over_root(walk, a, value), walk.moving(a), a_positive=True)
        if op is Op.ACOS:
            return Track(Range(value.hi, value.lo), ranges.negated(slope), here, rise, Bend.UNKNOWN, True)
        return Track(value, slope, here, rise)

    return rule


def tangent(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    """(1 + tan^2) a'; across a pole tan jumps."""
    (a,) = args
    g, ranges = walk.graph, walk.ranges
    half_turns = Range((a.value.lo - ranges.slack) / g.constant(_PI), (a.value.hi + ranges.slack) / g.constant(_PI))
    pole = half_turns.lo - 0.5 <= g.call(Op.FLOOR, half_turns.hi - 0.5)
    value = _everything_where(walk, pole, ranges.increasing(Op.TAN, a.value))
    square = ranges.squared(value)
    factor = Range(1.0 + square.lo, 1.0 + square.hi)
    slope = ranges.multiplied(factor, walk.moving(a), a_positive=True)
    return Track(value, _everything_where(walk, pole, slope), here, rise)


def wave(op: Op) -> Component:
    def rule(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
        (a,) = args
        other = walk.ranges.wave(Op.COS if op is Op.SIN else Op.SIN, a.value)
        factor = other if op is Op.SIN else walk.ranges.negated(other)
        slope = walk.ranges.multiplied(factor, walk.moving(a))
        return Track(walk.ranges.wave(op, a.value), slope, here, rise)

    return rule


def logarithm(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    (a,) = args
    g, ranges = walk.graph, walk.ranges
    value = Range(g.call(Op.LOG, g.max(a.value.lo, 1e-30)), g.call(Op.LOG, g.max(a.value.hi, 1e-30)))
    slope = ranges.multiplied(_over(walk, a, value), walk.moving(a), a_positive=True)
    return Track(value, slope, here, rise)


# ---- steps


def _everything_where(walk: Walk, condition: Expr, a: Range) -> Range:
    return Range(walk.graph.select(condition, -HUGE, a.lo), walk.graph.select(condition, HUGE, a.hi))


def jumping_unless(walk: Walk, known: Expr, a: Range) -> Range:
    return Range(walk.graph.select(known, a.lo, -HUGE), walk.graph.select(known, a.hi, HUGE))


def step(op: Op) -> Component:
    """sign, floor, round: flat unless they may jump."""

    def rule(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
        (a,) = args
        g, slack = walk.graph, walk.ranges.slack
        value = Range(g.call(op, a.value.lo - slack), g.call(op, a.value.hi + slack))
        still = point(g.constant(0.0))
        return Track(value, jumping_unless(walk, g.call(Op.EQUAL, value.lo, value.hi), still), here, rise)

    return rule


def modulo(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    """a - b floor(a / b); within [0, b] where the quotient is not known."""
    a, b = args
    g, ranges = walk.graph, walk.ranges
    quotient = ranges.multiplied(a.value, ranges.reciprocal(b.value, b.is_positive), b_positive=b.is_positive)
    lo, hi = g.call(Op.FLOOR, quotient.lo - ranges.slack), g.call(Op.FLOOR, quotient.hi + ranges.slack)
    known = g.call(Op.EQUAL, lo, hi)
    exact = ranges.subtracted(a.value, ranges.multiplied(b.value, point(lo)))
    value = Range(g.select(known, exact.lo, g.min(b.value.lo, 0.0)), g.select(known, exact.hi, g.max(b.value.hi, 0.0)))
    slope = walk.moving(a)
    if b.slope is not None:
        slope = ranges.subtracted(slope, ranges.multiplied(b.slope, point(lo)))
    return Track(value, jumping_unless(walk, known, slope), here, rise)


# ---- powers and angles


def power(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    """b a^(b-1) a' + a^b log(a) b'."""
    a, b = args
    ranges = walk.ranges
    if not b.moves and b.here.is_constant:
        exponent = b.here.number
        value = _powers(walk, a, exponent)
        lowered = ranges.multiplied(_powers(walk, a, exponent - 1.0), b.value)
        even = exponent % 2.0 == 0.0
        return Track(value, ranges.multiplied(lowered, walk.moving(a)), here, rise, Bend.UNKNOWN, even or a.is_positive)
    base = Range(walk.graph.max(a.value.lo, 1e-30), walk.graph.max(a.value.hi, 1e-30))
    value = _corner_powers(walk, base, b.value)
    terms = []
    if a.slope is not None:
        lowered = _corner_powers(walk, base, Range(b.value.lo - 1.0, b.value.hi - 1.0))
        terms.append(ranges.multiplied(ranges.multiplied(lowered, b.value, a_positive=True), a.slope))
    if b.slope is not None:
        growth = ranges.multiplied(value, ranges.increasing(Op.LOG, base), a_positive=True)
        terms.append(ranges.multiplied(growth, b.slope))
    known = walk.graph.constant(0.0) < a.value.lo
    slope = jumping_unless(walk, known, ranges.sum(terms))
    return Track(value, slope, here, rise, Bend.UNKNOWN, True)


def _powers(walk: Walk, a: Track, exponent: float) -> Range:
    """a to a constant power: whole powers of everything, others of the part that is not negative."""
    if exponent == 0.0:
        return point(walk.graph.constant(1.0))
    if exponent < 0.0:
        below = _powers(walk, a, -exponent)
        return walk.ranges.reciprocal(below, a.is_positive or exponent % 2.0 == 0.0 or exponent % 1.0 != 0.0)
    g = walk.graph
    if exponent % 1.0 != 0.0 or exponent > _LARGEST_POWER:
        base = Range(g.max(a.value.lo, 0.0), g.max(a.value.hi, 0.0))
        return Range(*(g.call(Op.POW, end, exponent) for end in base))
    base = walk.ranges.magnitude(a.value) if exponent % 2.0 == 0.0 else a.value
    return Range(*(reduce(operator.mul, [end] * int(exponent)) for end in base))


def _corner_powers(walk: Walk, a: Range, b: Range) -> Range:
    """pow over a > 0: monotone in each variable."""
    g = walk.graph
    corners = [g.call(Op.POW, x, y) for x in a for y in (b if not b.is_point else b[:1])]
    return Range(reduce(g.min, corners), reduce(g.max, corners))


def angle(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    """atan2(y, x), with the slope (x y' - y x') / (x x + y y); it jumps where y = 0, x <= 0 may be."""
    y, x = args
    g, ranges = walk.graph, walk.ranges
    slack = ranges.slack
    corners = [g.call(Op.ATAN2, b, a) for b in y.value for a in x.value]
    off_cut = g.call(Op.OR, slack < x.value.lo, g.call(Op.OR, slack < y.value.lo, y.value.hi < -slack))
    value = Range(
        g.select(off_cut, reduce(g.min, corners), -_PI - 1e-6), g.select(off_cut, reduce(g.max, corners), _PI + 1e-6)
    )
    top = ranges.subtracted(ranges.multiplied(x.value, walk.moving(y)), ranges.multiplied(y.value, walk.moving(x)))
    square = ranges.added(ranges.squared(x.value), ranges.squared(y.value))
    slope = ranges.multiplied(top, ranges.reciprocal(square, positive=True), b_positive=True)
    return Track(value, jumping_unless(walk, off_cut, slope), here, rise)


SQUARE_ROOT = increasing(_half_over, True)(Op.SQRT)
ARC_TANGENT = increasing(_over_squares, False)(Op.ATAN)
EXPONENTIAL = increasing(lambda walk, a, value: value, True)(Op.EXP)
