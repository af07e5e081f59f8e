"""Interval rules for derivatives: [f'] over a segment, given [value] and [derivative] of the arguments over it.

f' is Clarke's generalised derivative: the hull of both sides at a kink (abs, min, max), so that the mean value theorem
holds. Where an operation may jump (floor, round, sign, mod, select, atan2's cut) the slope is [-inf, inf].
After Galin et al. 2020 (segment tracing) and Aydinlilar & Zanni 2023 (forward inclusion).
`None` is the slope of what does not move.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field import interval_rules as rules
from sdfc.field.graph import Expr, Op, Type
from sdfc.field.interval_rules import Interval

Slope: TypeAlias = Interval | None
SlopeRule: TypeAlias = Callable[[Expr, Sequence[Interval], Sequence[Slope], Interval], Slope]

ZERO = np.zeros(1)
STILL = Interval(ZERO, ZERO)
ONE = np.ones(1)


def jumping_where(mask: NDArray[np.bool_], slope: Slope) -> Slope:
    """The slope, but [-inf, inf] where the mask says that the function may jump."""
    if not mask.any():
        return slope
    lo, hi = STILL if slope is None else slope
    return Interval(np.where(mask, -np.inf, lo), np.where(mask, np.inf, hi))


def _moving(slope: Slope) -> Interval:
    return STILL if slope is None else slope


def _times(a: Interval, slope: Slope) -> Slope:
    return None if slope is None else rules.multiplied(a, slope)


def _plus(a: Slope, b: Slope) -> Slope:
    if a is None or b is None:
        return a if b is None else b
    return rules.added(a, b)


def _minus(a: Slope, b: Slope) -> Slope:
    if b is None:
        return a
    return rules.negated(b) if a is None else rules.subtracted(a, b)


def _vector(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    return rules.vector([_moving(s) for s in slopes])


def _swizzle(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    return None if slopes[0] is None else rules.swizzle(node, _of_shape(slopes[0], values[0]))


def _of_shape(slope: Interval, value: Interval) -> Interval:
    """The slope of a vector may still be a scalar's (a jump): give it the vector's rows."""
    if slope.lo.ndim == value.lo.ndim:
        return slope
    rows = value.lo.shape[0]
    return Interval(*(np.broadcast_to(end, (rows, *end.shape)) for end in slope))


def _product(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    a, b = values
    if node.args[0] is node.args[1]:
        half = _times(a, slopes[0])
        return None if half is None else Interval(2.0 * half.lo, 2.0 * half.hi)
    return _plus(_times(b, slopes[0]), _times(a, slopes[1]))


def _dot(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    products = _product(node, values, slopes, result)
    return products if products is None or node.args[0].type is Type.FLOAT else rules.summed(products)


def _length(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """(v . v') / |v|, which Cauchy-Schwarz keeps within |v'|: also where v is 0."""
    (value,), (slope,) = values, slopes
    if slope is None:
        return None
    if node.args[0].type is Type.FLOAT:
        return _abs(node, values, slopes, result)
    slope = _of_shape(slope, value)
    limit = rules.length(slope).hi
    quotient = rules.settled(rules.divided(rules.summed(rules.multiplied(value, slope)), result))
    return Interval(np.maximum(quotient.lo, -limit), np.minimum(quotient.hi, limit))


def _abs(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    slope = slopes[0]
    if slope is None:
        return None
    same, mirrored = values[0].lo >= 0.0, values[0].hi <= 0.0
    lo = np.where(same, slope.lo, np.where(mirrored, -slope.hi, np.minimum(slope.lo, -slope.hi)))
    hi = np.where(same, slope.hi, np.where(mirrored, -slope.lo, np.maximum(slope.hi, -slope.lo)))
    return Interval(lo, hi)


def _least(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    a, b = values
    return _chosen(a.hi < b.lo, b.hi < a.lo, slopes)


def _greatest(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    a, b = values
    return _chosen(a.lo > b.hi, b.lo > a.hi, slopes)


def _chosen(first: NDArray[np.bool_], second: NDArray[np.bool_], slopes: Sequence[Slope]) -> Slope:
    if slopes[0] is None and slopes[1] is None:
        return None
    a, b = _moving(slopes[0]), _moving(slopes[1])
    lo = np.where(first, a.lo, np.where(second, b.lo, np.minimum(a.lo, b.lo)))
    hi = np.where(first, a.hi, np.where(second, b.hi, np.maximum(a.hi, b.hi)))
    return Interval(lo, hi)


def _step(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """sign, floor, round: flat unless they may jump."""
    return None if slopes[0] is None else jumping_where(~(result.lo == result.hi), None)


def _modulo(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    if slopes[0] is None and slopes[1] is None:
        return None
    quotient, decided = rules.floor_quotient(values[0], values[1])
    return jumping_where(~decided, _minus(slopes[0], _times(quotient, slopes[1])))


def _quotient(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """(a' - (a / b) b') / b."""
    top = _minus(slopes[0], _times(result, slopes[1]))
    return None if top is None else rules.divided(top, values[1])


def _scaled(factor: Callable[[Interval, Interval], Interval]) -> SlopeRule:
    """A differentiable function of one argument: `factor(value, result)` is its derivative."""

    def rule(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
        return None if slopes[0] is None else rules.multiplied(factor(values[0], result), slopes[0])

    return rule


def _one_minus_square(a: Interval) -> Interval:
    square = rules.squared(a)
    return Interval(np.maximum(rules.down(1.0 - square.hi), 0.0), rules.up(1.0 - square.lo))


def _arc(value: Interval, result: Interval) -> Interval:
    return rules.reciprocal(rules.root(_one_minus_square(value)))


def _tangent(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """(1 + tan^2) a'; across a pole tan jumps."""
    if slopes[0] is None:
        return None
    slope = rules.multiplied(rules.added(Interval(ONE, ONE), rules.squared(result)), slopes[0])
    return jumping_where(np.isinf(result.lo) | np.isinf(result.hi), slope)


def _arc_tangent(value: Interval, result: Interval) -> Interval:
    return rules.reciprocal(rules.added(Interval(ONE, ONE), rules.squared(value)))


def _twice_reciprocal(value: Interval, result: Interval) -> Interval:
    return rules.reciprocal(Interval(2.0 * result.lo, 2.0 * result.hi))


def _power(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """b a^(b-1) a' + a^b log(a) b'."""
    a, b = values
    base: Slope = None
    if slopes[0] is not None:
        lowered = rules.power(a, Interval(b.lo - 1.0, b.hi - 1.0) if b.lo is not b.hi else _point(b.lo - 1.0))
        base = rules.multiplied(rules.multiplied(b, lowered), slopes[0])
        # a negative base only has whole powers, and below zero these have a pole at 0
        pole = (a.hi >= 0.0) & ~(b.lo >= 0.0)
        base = jumping_where(~(a.lo >= 0.0) & (pole | ~_whole(b)), base)
    if slopes[1] is None:
        return base
    exponent = rules.multiplied(rules.multiplied(result, rules.logarithm(a)), slopes[1])
    return _plus(base, jumping_where(~(a.lo > 0.0), exponent))


def _point(x: rules.Array) -> Interval:
    return Interval(x, x)


def _whole(b: Interval) -> NDArray[np.bool_]:
    return np.asarray((b.lo == b.hi) & (np.floor(b.lo) == b.lo))


def _arc_tangent2(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """(x y' - y x') / (x^2 + y^2)."""
    (y, x), (rise, run) = values, slopes
    top = _minus(_times(x, rise), _times(y, run))
    if top is None:
        return None
    slope = rules.divided(top, rules.added(rules.squared(x), rules.squared(y)))
    return jumping_where(rules.on_branch_cut(y, x), slope)


def _select(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    condition = values[0]
    undecided = ~(condition.lo == condition.hi)
    chosen = _chosen(condition.lo > 0.0, ~(condition.hi > 0.0), slopes[1:])
    return jumping_where(undecided, chosen)


def _truth(node: Expr, values: Sequence[Interval], slopes: Sequence[Slope], result: Interval) -> Slope:
    """Not None: a select between constants jumps where its condition moves."""
    return STILL


SLOPES: dict[Op, SlopeRule] = {
    Op.VECTOR: _vector,
    Op.SWIZZLE: _swizzle,
    Op.DOT: _dot,
    Op.LENGTH: _length,
    Op.NEG: lambda node, values, slopes, result: _minus(None, slopes[0]),
    Op.ABS: _abs,
    Op.SIGN: _step,
    Op.FLOOR: _step,
    Op.ROUND: _step,
    Op.SQRT: _scaled(_twice_reciprocal),
    Op.SIN: _scaled(lambda value, result: rules.cosine(value)),
    Op.COS: _scaled(lambda value, result: rules.negated(rules.sine(value))),
    Op.TAN: _tangent,
    Op.ASIN: _scaled(_arc),
    Op.ACOS: _scaled(lambda value, result: rules.negated(_arc(value, result))),
    Op.ATAN: _scaled(_arc_tangent),
    Op.EXP: _scaled(lambda value, result: result),
    Op.LOG: _scaled(lambda value, result: rules.reciprocal(Interval(np.maximum(value.lo, 0.0), value.hi))),
    Op.ADD: lambda node, values, slopes, result: _plus(slopes[0], slopes[1]),
    Op.SUB: lambda node, values, slopes, result: _minus(slopes[0], slopes[1]),
    Op.MUL: _product,
    Op.DIV: _quotient,
    Op.MIN: _least,
    Op.MAX: _greatest,
    Op.MOD: _modulo,
    Op.POW: _power,
    Op.ATAN2: _arc_tangent2,
    Op.LESS: _truth,
    Op.LESS_EQUAL: _truth,
    Op.EQUAL: _truth,
    Op.AND: _truth,
    Op.OR: _truth,
    Op.NOT: _truth,
    Op.SELECT: _select,
}
