"""Constant folding in float64. Agrees with `sdfc.field.numeric` to rounding."""

import math
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


_SCALAR: dict[Op, Callable[..., float]] = {
    Op.NEG: lambda a: -a,
    Op.ABS: abs,
    Op.SIGN: _sign,
    Op.FLOOR: _floor,
    Op.ROUND: lambda a: _floor(a + 0.5),
    Op.SQRT: math.sqrt,
    Op.SIN: math.sin,
    Op.COS: math.cos,
    Op.TAN: math.tan,
    Op.ASIN: math.asin,
    Op.ACOS: math.acos,
    Op.ATAN: math.atan,
    Op.EXP: math.exp,
    Op.LOG: lambda a: math.log(a) if a else -math.inf,
    Op.ADD: lambda a, b: a + b,
    Op.SUB: lambda a, b: a - b,
    Op.MUL: lambda a, b: a * b,
    Op.DIV: _divide,
    Op.MIN: _least,
    Op.MAX: _greatest,
    Op.MOD: lambda a, b: a - b * _floor(_divide(a, b)),
    Op.POW: _power,
    Op.ATAN2: math.atan2,
    Op.LESS: lambda a, b: a < b,
    Op.LESS_EQUAL: lambda a, b: a <= b,
    Op.EQUAL: lambda a, b: a == b,
    Op.AND: lambda a, b: bool(a) and bool(b),
    Op.OR: lambda a, b: bool(a) or bool(b),
    Op.NOT: lambda a: not a,
}


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    products = [x * y for x, y in zip(a, b, strict=True)]
    return math.fsum(products) if all(map(math.isfinite, products)) else sum(products)


def fold(op: Op, args: list[tuple[float, ...]], size: int, value: object) -> tuple[float, ...]:
    """The components of `op(args)`, with IEEE's infinities and NaN; a boolean is 1.0 or 0.0."""

    def component(values: tuple[float, ...], index: int) -> float:
        return values[index] if len(values) > 1 else values[0]

    match op:
        case Op.VECTOR:
            return tuple(a[0] for a in args)
        case Op.SWIZZLE:
            assert isinstance(value, tuple)
            return tuple(args[0][int(i)] for i in value)
        case Op.DOT:
            return (_ieee(_dot)(args[0], args[1]),)
        case Op.LENGTH:
            return (math.hypot(*args[0]),)
        case Op.SELECT:
            chosen = args[1] if args[0][0] else args[2]
            return tuple(component(chosen, i) for i in range(size))
        case _:
            function = _ieee(_SCALAR[op])
            return tuple(function(*(component(a, i) for a in args)) for i in range(size))
