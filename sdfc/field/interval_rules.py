"""Interval rules of the field graph's operations: float64 end points, always rounded outward.

An `Interval` is a pair of arrays (lo, hi): a FLOAT's are (n,) or (1,), a VECk's (k, n) or (k, 1), as in `numeric`.
A boolean is an interval of 0 and 1: (1, 1) certainly true, (0, 0) certainly false, (0, 1) undecided.
A NaN end point stands for "unbounded on this side" until `settled` turns it into an infinity; every rule propagates it.

Rounding. A correctly rounded operation is within half an ulp, so multiplying the end points by 1 -/+ 2^-52 (at least
one ulp) and subtracting the least normal number where a product can underflow is outward; sums cannot underflow. It
costs a tenth of np.nextafter. Library functions get 16 ulps: NumPy's vector kernels promise at most 4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import Expr, Op, Type

Array: TypeAlias = NDArray[np.float64]

EPSILON = 2.0**-52
LARGEST = float(np.finfo(np.float64).max)
LEAST = 2.0 * float(np.finfo(np.float64).tiny)
LIBRARY_ULPS = 16
TWO_PI = 2.0 * np.pi


class Interval(NamedTuple):
    """[lo, hi] for every point; both arrays broadcast together."""

    lo: Array
    hi: Array


Rule: TypeAlias = Callable[[Expr, Sequence[Interval]], Interval]


def down(x: Array, ulps: int = 1) -> Array:
    """A number below every real that rounds to within `ulps` of x; below +inf the largest float (an overflow)."""
    result = x * (1.0 - ulps * EPSILON)
    np.minimum(result, x * (1.0 + ulps * EPSILON), out=result)
    np.minimum(result, LARGEST, out=result)
    return result


def up(x: Array, ulps: int = 1) -> Array:
    """The mirror image of `down`."""
    result = x * (1.0 - ulps * EPSILON)
    np.maximum(result, x * (1.0 + ulps * EPSILON), out=result)
    np.maximum(result, -LARGEST, out=result)
    return result


def settled(interval: Interval) -> Interval:
    """The same interval with its NaN end points made infinite."""
    lo, hi = interval
    if np.isnan(lo).any():
        lo = np.where(np.isnan(lo), -np.inf, lo)
    if np.isnan(hi).any():
        hi = np.where(np.isnan(hi), np.inf, hi)
    return Interval(lo, hi)


def whole_where(mask: NDArray[np.bool_], interval: Interval) -> Interval:
    """[-inf, inf] where the mask is set."""
    if not mask.any():
        return interval
    return Interval(np.where(mask, -np.inf, interval.lo), np.where(mask, np.inf, interval.hi))


def hull(a: Interval, b: Interval) -> Interval:
    """The least interval that contains both."""
    return Interval(np.minimum(a.lo, b.lo), np.maximum(a.hi, b.hi))


def negated(a: Interval) -> Interval:
    """-a, exactly."""
    return Interval(-a.hi, -a.lo)


def added(a: Interval, b: Interval) -> Interval:
    """a + b."""
    return Interval(down(a.lo + b.lo), up(a.hi + b.hi))


def subtracted(a: Interval, b: Interval) -> Interval:
    """a - b."""
    return Interval(down(a.lo - b.hi), up(a.hi - b.lo))


def multiplied(a: Interval, b: Interval) -> Interval:
    """a * b, with 0 * inf = 0: an infinite end point stands for arbitrarily large finite numbers."""
    if a.lo is a.hi:
        a, b = b, a
    first, second = a.lo * b.lo, a.hi * b.lo
    lo, hi = np.minimum(first, second), np.maximum(first, second)
    if b.lo is not b.hi:
        first, second = a.lo * b.hi, a.hi * b.hi
        np.minimum(lo, np.minimum(first, second), out=lo)
        np.maximum(hi, np.maximum(first, second), out=hi)
    if np.isnan(lo).any():
        lo, hi = _product_with_infinities(settled(a), settled(b))
    return Interval(down(lo) - LEAST, up(hi) + LEAST)


def _product_with_infinities(a: Interval, b: Interval) -> tuple[Array, Array]:
    return _extremes([np.nan_to_num(x * y, nan=0.0, posinf=np.inf, neginf=-np.inf) for x in a for y in b])


def _extremes(corners: Sequence[Array]) -> tuple[Array, Array]:
    """The least and the greatest of a box's four corner values."""
    a, b, c, d = corners
    return np.minimum(np.minimum(a, b), np.minimum(c, d)), np.maximum(np.maximum(a, b), np.maximum(c, d))


def squared(a: Interval) -> Interval:
    """a * a, knowing that both factors are the same number."""
    least = np.maximum(np.maximum(a.lo, -a.hi), 0.0)
    most = np.maximum(-a.lo, a.hi)
    return Interval(down(least * least), up(most * most) + LEAST)


def reciprocal(b: Interval) -> Interval:
    """1 / b; half-infinite where b only touches 0, everything where it contains 0 or is 0."""
    below = np.where(b.hi == 0.0, -np.inf, 1.0 / b.hi)
    above = np.where(b.lo == 0.0, np.inf, 1.0 / b.lo)
    result = Interval(down(below) - LEAST, up(above) + LEAST)
    return whole_where(((b.lo < 0.0) & (b.hi > 0.0)) | ((b.lo == 0.0) & (b.hi == 0.0)), result)


def divided(a: Interval, b: Interval) -> Interval:
    """a / b."""
    return multiplied(a, reciprocal(b))


def magnitude(a: Interval) -> Interval:
    """|a|, exactly."""
    return Interval(np.maximum(np.maximum(a.lo, -a.hi), 0.0), np.maximum(-a.lo, a.hi))


def root(a: Interval) -> Interval:
    """sqrt of the part of a that is not negative; unbounded above where there is none."""
    return Interval(np.maximum(down(np.sqrt(np.maximum(a.lo, 0.0))), 0.0), up(np.sqrt(a.hi)))


def length(a: Interval) -> Interval:
    """The Euclidean norm of a vector of intervals (k, n) -> (n,)."""
    squares = squared(a)
    size = a.lo.shape[0]
    return root(Interval(down(squares.lo.sum(axis=0), size), up(squares.hi.sum(axis=0), size)))


def summed(a: Interval) -> Interval:
    """The sum of a vector's components (k, n) -> (n,). Cancellation makes the error relative to the largest term."""
    result = Interval(a.lo[0], a.hi[0])
    for i in range(1, a.lo.shape[0]):
        result = added(result, Interval(a.lo[i], a.hi[i]))
    return result


def _library(function: Callable[[Array], Array], absolute: float = LEAST) -> Callable[[Interval], Interval]:
    """A rule for an increasing library function."""

    def rule(a: Interval) -> Interval:
        lo, hi = function(a.lo), function(a.hi)
        return Interval(down(lo, LIBRARY_ULPS) - absolute, up(hi, LIBRARY_ULPS) + absolute)

    return rule


def _may_contain(a: Interval, phase: float, period: float) -> NDArray[np.bool_]:
    """Where phase + k * period may lie in a for a whole k; generous by the rounding of the quotients."""
    lo, hi = (a.lo - phase) / period, (a.hi - phase) / period
    slack = 4.0 * EPSILON * (2.0 + np.maximum(np.abs(lo), np.abs(hi)))
    # negated, so that NaN counts as contained
    return ~(np.floor(hi + slack) < lo - slack)


def _wave(function: Callable[[Array], Array], peak: float) -> Callable[[Interval], Interval]:
    """A rule for sin or cos, whose maxima are at peak + 2 pi k and minima at peak + pi + 2 pi k."""

    def rule(a: Interval) -> Interval:
        first, second = function(a.lo), function(a.hi)
        lo = np.minimum(first, second) - LIBRARY_ULPS * EPSILON
        hi = np.maximum(first, second) + LIBRARY_ULPS * EPSILON
        lo = np.where(_may_contain(a, peak + np.pi, TWO_PI), -1.0, np.maximum(lo, -1.0))
        hi = np.where(_may_contain(a, peak, TWO_PI), 1.0, np.minimum(hi, 1.0))
        return Interval(lo, hi)

    return rule


sine = _wave(np.sin, np.pi / 2)
cosine = _wave(np.cos, 0.0)


def tangent(a: Interval) -> Interval:
    """tan; everything where a pole may lie in a."""
    return whole_where(_may_contain(a, np.pi / 2, np.pi), _library(np.tan, LIBRARY_ULPS * EPSILON)(a))


exponential = _library(np.exp)
_logarithm = _library(np.log)


def logarithm(a: Interval) -> Interval:
    """log of the part of a that is not negative; unbounded above where there is none."""
    return _logarithm(Interval(np.maximum(a.lo, 0.0), a.hi))


arc_tangent = _library(np.arctan)


def _clipped(a: Interval) -> Interval:
    return Interval(np.clip(a.lo, -1.0, 1.0), np.clip(a.hi, -1.0, 1.0))


def arc_sine(a: Interval) -> Interval:
    """asin of the part of a within [-1, 1]."""
    return _library(np.arcsin)(_clipped(a))


def arc_cosine(a: Interval) -> Interval:
    """acos of the part of a within [-1, 1]."""
    clipped = _clipped(a)
    lo, hi = np.arccos(clipped.hi), np.arccos(clipped.lo)
    return Interval(np.maximum(down(lo, LIBRARY_ULPS), 0.0), up(hi, LIBRARY_ULPS) + LEAST)


def corner_angles(y: Interval, x: Interval) -> Interval:
    """atan2 over a box that does not cross the branch cut: its corners are extreme."""
    lo, hi = _extremes([np.arctan2(b, a) for b in y for a in x])
    return Interval(down(lo, LIBRARY_ULPS) - LEAST, up(hi, LIBRARY_ULPS) + LEAST)


def arc_tangent2(y: Interval, x: Interval) -> Interval:
    """atan2(y, x); [-pi, pi] where the box meets the branch cut y = 0, x <= 0."""
    angles, cut = corner_angles(y, x), on_branch_cut(y, x)
    half_turn = np.pi * (1.0 + 2.0 * EPSILON)
    return Interval(np.where(cut, -half_turn, angles.lo), np.where(cut, half_turn, angles.hi))


def on_branch_cut(y: Interval, x: Interval) -> NDArray[np.bool_]:
    """Where atan2(y, x) may jump; NaN counts as meeting the cut."""
    return ~((x.lo > 0.0) | (y.lo > 0.0) | (y.hi < 0.0))


def floor_quotient(a: Interval, b: Interval) -> tuple[Interval, NDArray[np.bool_]]:
    """floor(a / b), and where it is one known number."""
    quotient = divided(a, b)
    lo, hi = np.floor(quotient.lo), np.floor(quotient.hi)
    return Interval(lo, hi), (lo == hi) & np.isfinite(lo)


def modulo(a: Interval, b: Interval) -> Interval:
    """a - b * floor(a / b), within [0, b] up to its own rounding."""
    quotient, decided = floor_quotient(a, b)
    exact = subtracted(a, multiplied(b, quotient))
    rounding = 4.0 * EPSILON * np.maximum(np.abs(a.lo), np.abs(a.hi))
    rounding = np.where(np.isfinite(rounding), rounding, np.inf)
    lo = np.where(b.lo > 0.0, -rounding, b.lo - rounding)
    hi = np.where(b.hi < 0.0, rounding, b.hi + rounding)
    mixed = ~((b.lo > 0.0) | (b.hi < 0.0))
    lo, hi = np.where(mixed, -np.inf, lo), np.where(mixed, np.inf, hi)
    return Interval(np.where(decided, exact.lo, lo), np.where(decided, exact.hi, hi))


def power(a: Interval, b: Interval) -> Interval:
    """pow(a, b): whole exponents for every base, others for the part of a that is not negative (the rest is NaN)."""
    whole_exponent = (b.lo == b.hi) & (np.floor(b.lo) == b.lo) & np.isfinite(b.lo)
    size = magnitude(a)
    natural = _corner_powers(Interval(np.maximum(a.lo, 0.0), np.maximum(a.hi, 0.0)), b)
    if not (a.lo < 0.0).any():
        return natural
    unsigned = _corner_powers(size, b)
    signed = Interval(-unsigned.hi, unsigned.hi)
    even = whole_exponent & (np.mod(b.lo, 2.0) == 0.0)
    below = _corner_powers(Interval(np.maximum(-a.hi, 0.0), np.maximum(-a.lo, 0.0)), b)
    odd_lo = np.where(a.hi <= 0.0, -below.hi, np.where(b.lo < 0.0, -np.inf, -below.hi))
    odd_hi = np.where(a.hi <= 0.0, -below.lo, np.where(b.lo < 0.0, np.inf, natural.hi))
    lo = np.where(even, unsigned.lo, np.where(whole_exponent, odd_lo, signed.lo))
    hi = np.where(even, unsigned.hi, np.where(whole_exponent, odd_hi, signed.hi))
    negative = a.lo < 0.0
    return Interval(np.where(negative, lo, natural.lo), np.where(negative, hi, natural.hi))


def _corner_powers(a: Interval, b: Interval) -> Interval:
    """pow over a >= 0: monotone in each variable, so the corners are extreme."""
    lo, hi = _extremes([np.power(x, y) for x in a for y in b])
    return Interval(np.maximum(down(lo, LIBRARY_ULPS) - LEAST, 0.0), up(hi, LIBRARY_ULPS) + LEAST)


def _truth(certain: NDArray[np.bool_], possible: NDArray[np.bool_]) -> Interval:
    return Interval(certain.astype(np.float64), possible.astype(np.float64))


def less(a: Interval, b: Interval) -> Interval:
    """a < b."""
    return _truth(a.hi < b.lo, ~(a.lo >= b.hi))


def less_equal(a: Interval, b: Interval) -> Interval:
    """a <= b."""
    return _truth(a.hi <= b.lo, ~(a.lo > b.hi))


def equal(a: Interval, b: Interval) -> Interval:
    """a == b (scalars)."""
    return _truth((a.lo == a.hi) & (b.lo == b.hi) & (a.lo == b.lo), ~((a.hi < b.lo) | (b.hi < a.lo)))


def complement(a: Interval) -> Interval:
    """not a."""
    return Interval(1.0 - a.hi, 1.0 - a.lo)


def select(condition: Interval, then: Interval, otherwise: Interval) -> Interval:
    """The chosen side, or the hull of both."""
    both = hull(then, otherwise)
    lo = np.where(condition.lo > 0.0, then.lo, np.where(condition.hi > 0.0, both.lo, otherwise.lo))
    hi = np.where(condition.lo > 0.0, then.hi, np.where(condition.hi > 0.0, both.hi, otherwise.hi))
    return Interval(lo, hi)


def vector(args: Sequence[Interval]) -> Interval:
    """k scalars, stacked to (k, n)."""
    lo = np.stack(np.broadcast_arrays(*(a.lo for a in args)))
    if all(a.lo is a.hi for a in args):
        return Interval(lo, lo)
    return Interval(lo, np.stack(np.broadcast_arrays(*(a.hi for a in args))))


def swizzle(node: Expr, a: Interval) -> Interval:
    """Components of a vector (k, n); one component is a scalar (n,)."""
    assert isinstance(node.value, tuple)
    picked = [int(i) for i in node.value]
    if node.args[0].type is Type.FLOAT:  # a scalar's .x, .xx, ...
        return a if len(picked) == 1 else vector([a] * len(picked))
    index = picked[0] if len(picked) == 1 else picked
    lo = a.lo[index]
    return Interval(lo, lo if a.lo is a.hi else a.hi[index])


def _monotone(function: Callable[[Array], Array]) -> Rule:
    return lambda _, a: Interval(function(a[0].lo), function(a[0].hi))


def _multiply(node: Expr, args: Sequence[Interval]) -> Interval:
    return squared(args[0]) if node.args[0] is node.args[1] else multiplied(args[0], args[1])


def _dot(node: Expr, args: Sequence[Interval]) -> Interval:
    products = _multiply(node, args)
    return products if node.args[0].type is Type.FLOAT else summed(products)


def _length(node: Expr, args: Sequence[Interval]) -> Interval:
    return magnitude(args[0]) if node.args[0].type is Type.FLOAT else length(args[0])


RULES: dict[Op, Rule] = {
    Op.VECTOR: lambda _, a: vector(a),
    Op.SWIZZLE: lambda node, a: swizzle(node, a[0]),
    Op.DOT: _dot,
    Op.LENGTH: _length,
    Op.NEG: lambda _, a: negated(a[0]),
    Op.ABS: lambda _, a: magnitude(a[0]),
    Op.SIGN: _monotone(np.sign),
    Op.FLOOR: _monotone(np.floor),
    Op.ROUND: lambda _, a: Interval(np.floor(down(a[0].lo + 0.5)), np.floor(up(a[0].hi + 0.5))),
    Op.SQRT: lambda _, a: root(a[0]),
    Op.SIN: lambda _, a: sine(a[0]),
    Op.COS: lambda _, a: cosine(a[0]),
    Op.TAN: lambda _, a: tangent(a[0]),
    Op.ASIN: lambda _, a: arc_sine(a[0]),
    Op.ACOS: lambda _, a: arc_cosine(a[0]),
    Op.ATAN: lambda _, a: arc_tangent(a[0]),
    Op.EXP: lambda _, a: exponential(a[0]),
    Op.LOG: lambda _, a: logarithm(a[0]),
    Op.ADD: lambda _, a: added(a[0], a[1]),
    Op.SUB: lambda _, a: subtracted(a[0], a[1]),
    Op.MUL: _multiply,
    Op.DIV: lambda _, a: divided(a[0], a[1]),
    Op.MIN: lambda _, a: Interval(np.minimum(a[0].lo, a[1].lo), np.minimum(a[0].hi, a[1].hi)),
    Op.MAX: lambda _, a: Interval(np.maximum(a[0].lo, a[1].lo), np.maximum(a[0].hi, a[1].hi)),
    Op.MOD: lambda _, a: modulo(a[0], a[1]),
    Op.POW: lambda _, a: power(a[0], a[1]),
    Op.ATAN2: lambda _, a: arc_tangent2(a[0], a[1]),
    Op.LESS: lambda _, a: less(a[0], a[1]),
    Op.LESS_EQUAL: lambda _, a: less_equal(a[0], a[1]),
    Op.EQUAL: lambda _, a: equal(a[0], a[1]),
    Op.AND: lambda _, a: Interval(np.minimum(a[0].lo, a[1].lo), np.minimum(a[0].hi, a[1].hi)),
    Op.OR: lambda _, a: Interval(np.maximum(a[0].lo, a[1].lo), np.maximum(a[0].hi, a[1].hi)),
    Op.NOT: lambda _, a: complement(a[0]),
    Op.SELECT: lambda _, a: select(a[0], a[1], a[2]),
}
