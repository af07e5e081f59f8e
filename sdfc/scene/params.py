"""`param` declarations: live values, each with its range."""

from __future__ import annotations

import math

from sdfc.diagnostics import Span, scene_error
from sdfc.field.graph import Expr, Type
from sdfc.scene import values
from sdfc.scene.limits import LARGEST_NUMBER
from sdfc.scene.model import Param
from sdfc.scene.names import Names, evaluate
from sdfc.scene.values import Quantity, RangeValue, Unit, words
from sdfc.syntax import tree


def declare(declaration: tree.ParamDeclaration, names: Names) -> Quantity:
    """The param's value: an expression that stays live. The first call puts it among the scene's params."""
    name = declaration.name.text
    default = values.quantity(evaluate(declaration.default, names), declaration.default.span)
    if default.expr.type is Type.BOOL:
        raise scene_error("a param is a number, an angle, a vector or a colour", declaration.default.span)
    known = names.context.params.get(name)
    if known is None:
        names.context.params[name] = _param(declaration, default, names)
    elif known.span is not declaration.span:
        raise scene_error(f"two files declare a param '{name}'", declaration.name.span)
    return Quantity(names.context.graph.param(name, default.expr.type), default.unit)


def _param(declaration: tree.ParamDeclaration, default: Quantity, names: Names) -> Param:
    span = declaration.default.span
    numbers = _finite(values.constant(default.expr, "the default of a param", span), span)
    low, high = _limits(declaration, default, names)
    for number in numbers:
        if (low is not None and number < low) or (high is not None and number > high):
            shown = f"{_shown(number, default)} is outside of {_shown(low, default)}..{_shown(high, default)}"
            raise scene_error(f"the default {shown}", span, "the value before 'in' lies within the range")
    return Param(declaration.name.text, default.expr.type, numbers, low, high, default.unit.value, declaration.span)


def _limits(declaration: tree.ParamDeclaration, default: Quantity, names: Names) -> tuple[float | None, float | None]:
    if declaration.range is None:
        if default.unit is Unit.COLOR:
            return 0.0, 1.0
        name = declaration.name
        raise scene_error(f"the param '{name.text}' has no range", name.span, "write param x = 1 in 0..2")
    place = declaration.range.span
    limits = evaluate(declaration.range, names)
    if not isinstance(limits, RangeValue):
        raise scene_error(f"expected a range low..high, not {words(limits)}", place)
    low, high = _limit(limits.low, default, place), _limit(limits.high, default, place)
    if not low < high:
        raise scene_error(f"the range {_shown(low, default)}..{_shown(high, default)} is empty", place)
    return low, high


def _limit(value: Quantity, default: Quantity, place: Span) -> float:
    unit = Unit.NUMBER if default.unit is Unit.COLOR else default.unit
    if value.unit is not unit or value.expr.type is not Type.FLOAT:
        raise scene_error(
            f"the default is {words(default)}, and its range has {words(value)}", place, "both need the same unit"
        )
    return _finite(values.constant(value.expr, "a range", place), place)[0]


def _finite(expr: Expr, span: Span) -> tuple[float, ...]:
    if not all(map(math.isfinite, expr.numbers)):
        raise scene_error("a param must be finite", span)
    if max(map(abs, expr.numbers)) > LARGEST_NUMBER:
        raise scene_error(f"a param must be within {LARGEST_NUMBER:g} of zero", span)
    return expr.numbers


def _shown(number: float | None, like: Quantity) -> str:
    if number is None:
        return ""
    return f"{math.degrees(number):g}deg" if like.unit is Unit.ANGLE else f"{number:g}"
