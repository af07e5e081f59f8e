"""Constant folding in float64. Agrees with `sdfc.field.numeric` to rounding."""

import math
import operator
from collections.abc import Callable, Sequence

from sdfc.field.operations import Op


def _ieee(function: Callable[..., float]) -> Callable[..., float]:
    """NaN and infinity where Python's math raises: they are reported by the caller, with a place."""

    def call(*values: float) -> float:
        try:
            return float(function(*values))
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return call


def _sign(x: float) -> float:
    return math.nan if math.isnan(x) else float((x > 0) - (x < 0))


def _floor(x: float) -> float:
    return float(math.floor(x)) if math.isfinite(x) else x


def _divide(a: float, b: float) -> float:
    if b:
        return a / b
    return math.copysign(1.0, b) * math.copysign(math.inf, a) if a and not math.isnan(a) else math.nan


def _power(x: float, y: float) -> float:
    try:
        return math.pow(x, y)
    except OverflowError:
        return -math.inf if x < 0 and y % 2 == 1 else math.inf
    except ValueError:  # a negative base to a broken exponent, or zero to a negative one
        return math.copysign(math.inf, x) if x == 0 and y % 2 == 1 else math.inf if x == 0 else math.nan


def _least(a: float, b: float) -> float:
    return a + b if math.isnan(a + b) and (math.isnan(a) or math.isnan(b)) else min(a, b)


def _greatest(a: float, b: float) -> float:
    return -_least(-a, -b)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    products = [x * y for x, y in zip(a, b, strict=True)]
    return math.fsum(products) if all(map(math.isfinite, products)) else sum(products)


# Those of Python's own operators never raise; a comparison's bool is made a float with all that it is among.
_SCALAR: dict[Op, Callable[..., float]] = {
    Op.NEG: operator.neg,
    Op.ABS: abs,
    Op.SIGN: _sign,
    Op.FLOOR: _floor,
    Op.ROUND: lambda a: _floor(a + 0.5),
    Op.SQRT: _ieee(math.sqrt),
    Op.SIN: _ieee(math.sin),
    Op.COS: _ieee(math.cos),
    Op.TAN: _ieee(math.tan),
    Op.ASIN: _ieee(math.asin),
    Op.ACOS: _ieee(math.acos),
    Op.ATAN: math.atan,
    Op.EXP: _ieee(math.exp),
    Op.LOG: _ieee(lambda a: math.log(a) if a else -math.inf),
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.DIV: _divide,
    Op.MIN: _least,
    Op.MAX: _greatest,
    Op.MOD: lambda a, b: a - b * _floor(_divide(a, b)),
    Op.POW: _power,
    Op.ATAN2: math.atan2,
    Op.LESS: _ieee(operator.lt),
    Op.LESS_EQUAL: _ieee(operator.le),
    Op.EQUAL: _ieee(operator.eq),
    Op.AND: lambda a, b: float(bool(a) and bool(b)),
    Op.OR: lambda a, b: float(bool(a) or bool(b)),
    Op.NOT: lambda a: float(not a),
}
_DOT = _ieee(_dot)


def _wide(values: tuple[float, ...], size: int) -> tuple[float, ...]:
    """A scalar among vectors is a vector."""
    return values * size if len(values) == 1 else values


def fold(op: Op, args: Sequence[tuple[float, ...]], size: int, value: object) -> tuple[float, ...]:
    """The components of `op(args)`, with IEEE's infinities and NaN; a boolean is 1.0 or 0.0."""
    scalar = _SCALAR.get(op)
    if scalar is not None:
        return tuple(map(scalar, *(args if size == 1 else [_wide(a, size) for a in args])))
    match op:
        case Op.VECTOR:
            return tuple([a[0] for a in args])
        case Op.SWIZZLE:
            assert isinstance(value, tuple)
            return tuple([args[0][int(i)] for i in value])
        case Op.DOT:
            return (_DOT(args[0], args[1]),)
        case Op.LENGTH:
            return (math.hypot(*args[0]),)
        case Op.SELECT:
            return _wide(args[1] if args[0][0] else args[2], size)
        case _:
            raise AssertionError(f"{op} has no arguments")
