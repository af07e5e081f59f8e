"""Interval rules for second derivatives along a line: how hard a field may bend down, kinks counted.

At a kink the derivative jumps: upwards (abs, max, a length at 0) the second derivative is +inf, downwards (min) -inf.
Where -K bounds it from below f + K x x / 2 is convex, whatever f does upwards: f(t + x) >= f(t) + f'(t) x - K x x / 2.
`None` is the second derivative of what is affine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field import interval_rules as rules
from sdfc.field.graph import Expr, Op, Type
from sdfc.field.interval_rules import Interval
from sdfc.field.interval_slopes import STILL, Slope

Bend: TypeAlias = Interval | None
# (node, values, slopes, bends of the arguments, the node's own value, its own slope)
BendRule: TypeAlias = Callable[[Expr, Sequence[Interval], Sequence[Slope], Sequence[Bend], Interval, Slope], Bend]
Factor: TypeAlias = Callable[[Interval, Interval], Interval]

_EVERYTHING = Interval(np.array([-np.inf]), np.array([np.inf]))


def moving(a: Interval | None) -> Interval:
    """Also of what does not."""
    return STILL if a is None else a


def _plus(a: Bend, b: Bend) -> Bend:
    if a is None or b is None:
        return a if b is None else b
    return rules.added(a, b)


def _times(a: Interval, b: Bend) -> Bend:
    return None if b is None else rules.multiplied(a, b)


def _twice(a: Bend) -> Bend:
    return None if a is None else Interval(2.0 * a.lo, 2.0 * a.hi)


def _negated(a: Bend) -> Bend:
    return None if a is None else rules.negated(a)


def everything_where(mask: NDArray[np.bool_], a: Bend) -> Bend:
    """[-inf, inf] where the mask is set."""
    return a if not mask.any() else rules.whole_where(mask, Interval(*np.broadcast_arrays(*moving(a), mask)[:2]))


def _smooth(first: Factor, second: Factor) -> BendRule:
    """phi'(a) a'' + phi''(a) a' a', of factors that are told `(a, phi(a))`."""

    def rule(
        node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
    ) -> Bend:
        if s[0] is None:
            return None
        curved = rules.multiplied(second(v[0], result), rules.squared(s[0]))
        return _plus(_times(first(v[0], result), b[0]), curved)

    return rule


def _product(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    if node.args[0] is node.args[1]:
        steep = None if s[0] is None else rules.squared(s[0])
        return _twice(_plus(steep, _times(v[0], b[0])))
    crossed = None if s[0] is None or s[1] is None else rules.multiplied(s[0], s[1])
    return _plus(_plus(_times(v[1], b[0]), _times(v[0], b[1])), _twice(crossed))


def _dot(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    products = _product(node, v, s, b, result, slope)
    return products if products is None or node.args[0].type is Type.FLOAT else rules.summed(_rows(products, v[0]))


def _rows(bend: Interval, value: Interval) -> Interval:
    """A vector's bend may still be a scalar's (a jump): give it the vector's rows."""
    if bend.lo.ndim == value.lo.ndim:
        return bend
    return Interval(*(np.broadcast_to(end, (value.lo.shape[0], *end.shape)) for end in bend))


def _quotient(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    """(a'' - 2 q' b' - q b'') / b."""
    if s[1] is None:
        return None if b[0] is None else rules.divided(b[0], v[1])
    top = _plus(b[0], _negated(_twice(rules.multiplied(moving(slope), s[1]))))
    top = _plus(top, _negated(_times(result, b[1])))
    return None if top is None else rules.divided(top, v[1])


def _abs(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    if s[0] is None:
        return None
    bend, same, mirrored = moving(b[0]), v[0].lo >= 0.0, v[0].hi <= 0.0
    lo = np.where(same, bend.lo, np.where(mirrored, -bend.hi, np.minimum(bend.lo, -bend.hi)))
    hi = np.where(same, bend.hi, np.where(mirrored, -bend.lo, np.inf))
    return Interval(lo, hi)


def _extremum(op: Op) -> BendRule:
    def rule(
        node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
    ) -> Bend:
        if s[0] is None and s[1] is None:
            return None
        first, second = (v[0].hi < v[1].lo, v[1].hi < v[0].lo)
        first, second = (first, second) if op is Op.MIN else (second, first)
        x, y = moving(b[0]), moving(b[1])
        least = np.full(1, -np.inf) if op is Op.MIN else np.minimum(x.lo, y.lo)
        most = np.maximum(x.hi, y.hi) if op is Op.MIN else np.full(1, np.inf)
        lo = np.where(first, x.lo, np.where(second, y.lo, least))
        hi = np.where(first, x.hi, np.where(second, y.hi, most))
        return Interval(lo, hi)

    return rule


def _length(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    """(|v'|^2 - l'^2) / |v| + v . v'' / |v|: the first is never below 0, the second never below -|v''|."""
    if s[0] is None:
        return None
    if node.args[0].type is Type.FLOAT:
        return _abs(node, v, s, b, result, slope)
    across = rules.squared(rules.length(_rows(s[0], v[0])))
    bow = rules.settled(Interval(np.zeros(1), rules.divided(across, result).hi))
    if b[0] is None:
        return bow
    bend = _rows(b[0], v[0])
    ratio = rules.settled(rules.divided(v[0], result))
    # of one sign where the component is: a hair of the other sign, times an upward kink, would be everything
    least, most = np.where(v[0].lo >= 0.0, 0.0, -1.0), np.where(v[0].hi <= 0.0, 0.0, 1.0)
    unit = Interval(np.clip(ratio.lo, least, most), np.clip(ratio.hi, least, most))
    turned = rules.settled(rules.summed(rules.settled(rules.multiplied(unit, bend))))
    worst = -rules.length(rules.settled(bend)).hi
    return rules.added(bow, Interval(np.maximum(turned.lo, worst), turned.hi))


def _step(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    return None if s[0] is None else everything_where(~(result.lo == result.hi), None)


def _modulo(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    quotient, decided = rules.floor_quotient(v[0], v[1])
    return everything_where(~decided, _plus(b[0], _negated(_times(quotient, b[1]))))


def _select(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    chosen = rules.select(v[0], moving(b[1]), moving(b[2]))
    return everything_where(~(v[0].lo == v[0].hi), chosen)


def _power(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    """Of a constant power; nothing is known of a moving one."""
    if s[1] is not None:
        return _EVERYTHING
    if s[0] is None:
        return None
    exponent = v[1]
    once, twice = (Interval(exponent.lo - n, exponent.hi - n) for n in (1.0, 2.0))
    lowered, lowest = rules.power(v[0], once), rules.power(v[0], twice)
    first = rules.multiplied(exponent, lowered)
    second = rules.multiplied(rules.multiplied(exponent, once), lowest)
    bend = _plus(_times(first, b[0]), rules.multiplied(second, rules.squared(s[0])))
    whole = (exponent.lo == exponent.hi) & (np.floor(exponent.lo) == exponent.lo) & (exponent.lo >= 2.0)
    return everything_where(~(whole | (v[0].lo > 0.0)), bend)


def _angle(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    """(x y'' - y x'' - 2 a' (x x' + y y')) / (x^2 + y^2)."""
    y, x = v
    square = rules.added(rules.squared(x), rules.squared(y))
    radial = _plus(_times(x, s[1]), _times(y, s[0]))
    top = _plus(_times(x, b[0]), _negated(_times(y, b[1])))
    if radial is not None:
        top = _plus(top, _negated(_twice(rules.multiplied(moving(slope), radial))))
    bend = None if top is None else rules.divided(top, square)
    return everything_where(rules.on_branch_cut(y, x), bend)


def _still(
    node: Expr, v: Sequence[Interval], s: Sequence[Slope], b: Sequence[Bend], result: Interval, slope: Slope
) -> Bend:
    return None


def _one_plus_square(a: Interval) -> Interval:
    square = rules.squared(a)
    return Interval(rules.down(1.0 + square.lo), rules.up(1.0 + square.hi))


def _one_minus_square(a: Interval) -> Interval:
    square = rules.squared(a)
    return Interval(np.maximum(rules.down(1.0 - square.hi), 0.0), rules.up(1.0 - square.lo))


def _scaled(a: Interval, factor: float) -> Interval:
    return Interval(factor * a.lo, factor * a.hi) if factor > 0.0 else Interval(factor * a.hi, factor * a.lo)


def _arc_first(value: Interval, result: Interval) -> Interval:
    return rules.reciprocal(rules.root(_one_minus_square(value)))


def _arc_second(value: Interval, result: Interval) -> Interval:
    over = _arc_first(value, result)
    return rules.multiplied(value, rules.multiplied(over, rules.squared(over)))


def _tangent_second(value: Interval, result: Interval) -> Interval:
    return _scaled(rules.multiplied(result, _one_plus_square(result)), 2.0)


def _arc_tangent_second(value: Interval, result: Interval) -> Interval:
    over = rules.reciprocal(_one_plus_square(value))
    return _scaled(rules.multiplied(value, rules.squared(over)), -2.0)


def _root_second(value: Interval, result: Interval) -> Interval:
    over = rules.reciprocal(result)
    return _scaled(rules.multiplied(over, rules.squared(over)), -0.25)


def _positive_part(a: Interval) -> Interval:
    return Interval(np.maximum(a.lo, 0.0), a.hi)


BENDS: dict[Op, BendRule] = {
    **dict.fromkeys((Op.LESS, Op.LESS_EQUAL, Op.EQUAL, Op.AND, Op.OR, Op.NOT), _still),
    Op.VECTOR: lambda node, v, s, b, r, t: rules.vector([moving(x) for x in b]),
    Op.SWIZZLE: lambda node, v, s, b, r, t: None if b[0] is None else rules.swizzle(node, _rows(b[0], v[0])),
    Op.DOT: _dot,
    Op.LENGTH: _length,
    Op.NEG: lambda node, v, s, b, r, t: _negated(b[0]),
    Op.ABS: _abs,
    Op.SIGN: _step,
    Op.FLOOR: _step,
    Op.ROUND: _step,
    Op.SQRT: _smooth(lambda a, r: rules.reciprocal(_scaled(r, 2.0)), _root_second),
    Op.SIN: _smooth(lambda a, r: rules.cosine(a), lambda a, r: rules.negated(r)),
    Op.COS: _smooth(lambda a, r: rules.negated(rules.sine(a)), lambda a, r: rules.negated(r)),
    Op.TAN: _smooth(lambda a, r: _one_plus_square(r), _tangent_second),
    Op.ASIN: _smooth(_arc_first, _arc_second),
    Op.ACOS: _smooth(lambda a, r: rules.negated(_arc_first(a, r)), lambda a, r: rules.negated(_arc_second(a, r))),
    Op.ATAN: _smooth(lambda a, r: rules.reciprocal(_one_plus_square(a)), _arc_tangent_second),
    Op.EXP: _smooth(lambda a, r: r, lambda a, r: r),
    Op.LOG: _smooth(
        lambda a, r: rules.reciprocal(_positive_part(a)),
        lambda a, r: rules.negated(rules.squared(rules.reciprocal(_positive_part(a)))),
    ),
    Op.ADD: lambda node, v, s, b, r, t: _plus(b[0], b[1]),
    Op.SUB: lambda node, v, s, b, r, t: _plus(b[0], _negated(b[1])),
    Op.MUL: _product,
    Op.DIV: _quotient,
    Op.MIN: _extremum(Op.MIN),
    Op.MAX: _extremum(Op.MAX),
    Op.MOD: _modulo,
    Op.POW: _power,
    Op.ATAN2: _angle,
    Op.SELECT: _select,
}
