"""What is given to a call: evaluated, matched with the parameters' names, converted to their kinds, checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.field.graph import Expr
from sdfc.scene import values
from sdfc.scene.arithmetic import elements
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.limits import LARGEST_NUMBER, LONGEST_LIST
from sdfc.scene.names import Context, Names, Problems, evaluate
from sdfc.scene.ranges import samples
from sdfc.scene.values import Value
from sdfc.shape.definition import Argument, Kind, Parameter
from sdfc.syntax import tree


@dataclass(frozen=True, slots=True)
class Given:
    """One argument."""

    value: Value
    span: Span
    name: tree.Identifier | None = None


def gather(arguments: Sequence[tree.Argument], names: Names) -> list[Given]:
    """The arguments evaluated, loops expanded; all their errors at once."""
    problems = Problems()
    given: list[Given] = []
    for argument in arguments:
        try:
            given += _evaluated(argument, names)
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return given


def _evaluated(argument: tree.Argument, names: Names) -> list[Given]:
    value = argument.value
    if not isinstance(value, tree.Loop):
        return [Given(evaluate(value, names), value.span, argument.name)]
    if argument.name is not None:
        raise scene_error("a named argument is one value, not a loop", value.span, "write a list: [for … in …: …]")
    return [Given(found, span) for found, span in elements([value], names)]


def match(
    what: str,
    parameters: Sequence[str],
    given: Sequence[Given],
    span: Span,
    most_positional: int | None = None,
    word: str = "parameter",
) -> dict[str, Given]:
    """Arguments by parameter; those without a name go to the first parameters. All errors at once."""
    problems = Problems()
    matched: dict[str, Given] = {}
    free = [g for g in given if g.name is None]
    most = len(parameters) if most_positional is None else most_positional
    if len(free) > most:
        problems.add(_too_many(what, parameters, free, most, span))
    matched.update(zip(parameters[:most], free, strict=False))
    for argument in given:
        if argument.name is None:
            continue
        name = argument.name.text
        if name not in parameters:
            hint = did_you_mean(name, parameters) or _listed(parameters)
            problems.add(Diagnostic(f"{what} has no {word} '{name}'", argument.name.span, hint))
        elif name in matched:
            problems.add(Diagnostic(f"{what} is given '{name}' twice", argument.name.span))
        matched.setdefault(name, argument)
    problems.finish()
    return matched


def _listed(parameters: Sequence[str]) -> str:
    return "it has " + ", ".join(parameters) if parameters else "it has none"


def _too_many(what: str, parameters: Sequence[str], free: Sequence[Given], most: int, span: Span) -> Diagnostic:
    place = free[most].span if free[most].span.source is span.source else span
    if most < len(parameters):
        return Diagnostic(
            f"{what} takes {most} argument{'s' * (most != 1)} without a name", place, f"write {parameters[most]}: …"
        )
    return Diagnostic(f"{what} takes {most} argument{'s' * (most != 1)}, not {len(free)}", place, _listed(parameters))


# --- kinds


def _scalar(value: Value, span: Span) -> Expr:
    return values.number(value, span)


def _count(value: Value, span: Span) -> Expr:
    count = values.constant(values.number(value, span), "a count", span)
    if count.number != round(count.number) if math.isfinite(count.number) else False:
        raise scene_error(f"expected a whole number, not {count.number:g}", span)
    return count


def _vector(size: int) -> Callable[[Value, Span], Expr]:
    return lambda value, span: values.vector(value, size, span, spread=True)


def _list_of(element: Callable[[Value, Span], Expr]) -> Callable[[Value, Span], Argument]:
    def convert(value: Value, span: Span) -> Argument:
        found = values.items(value, span)
        if not found:
            raise scene_error("the list is empty", span)
        if len(found) > LONGEST_LIST:
            raise scene_error(f"a list of {len(found)} values; {LONGEST_LIST} are allowed here", span)
        return tuple([element(item, span) for item in found])

    return convert


_CONVERSIONS: Mapping[Kind, Callable[[Value, Span], Argument]] = MappingProxyType(
    {
        Kind.NUMBER: _scalar,
        Kind.LENGTH: _scalar,
        Kind.ANGLE: values.angle,
        Kind.COUNT: _count,
        Kind.BOOLEAN: values.boolean,
        Kind.VECTOR2: _vector(2),
        Kind.VECTOR3: _vector(3),
        Kind.POINT2: _vector(2),
        Kind.POINT3: _vector(3),
        Kind.NUMBERS: _list_of(_scalar),
        Kind.POINTS2: _list_of(lambda value, span: values.vector(value, 2, span)),
        Kind.POINTS3: _list_of(lambda value, span: values.vector(value, 3, span)),
    }
)


def convert(parameter: Parameter, given: Given) -> Argument:
    """The value as the parameter's kind takes it. The error says which parameter it is."""
    try:
        return _CONVERSIONS[parameter.kind](given.value, given.span)
    except SceneError as error:
        first = error.diagnostics[0]
        message = f"{parameter.name}: {first.message}"
        raise SceneError(Diagnostic(message, first.span, first.hint)) from None


# --- limits


def check(parameter: Parameter, argument: Argument, span: Span, context: Context) -> None:
    """Raises SceneError where the value is not finite or outside of the limits, for any value of a param."""
    for expr in argument if isinstance(argument, tuple) else (argument,):
        if parameter.kind is Kind.BOOLEAN:
            continue
        for value, where in samples(expr, context):
            for number in value.numbers:
                complaint = _complaint(parameter, number)
                if complaint is not None:
                    raise scene_error(f"{parameter.name} {complaint}, not {_shown(parameter, number)}{where}", span)


def _shown(parameter: Parameter, number: float) -> str:
    return f"{math.degrees(number):g}deg" if parameter.kind is Kind.ANGLE else f"{number:g}"


def _complaint(parameter: Parameter, number: float) -> str | None:
    if not math.isfinite(number):
        return "must be a finite number"
    if abs(number) > LARGEST_NUMBER:
        return f"must be within {LARGEST_NUMBER:g} of zero"
    low, high = parameter.minimum, parameter.maximum
    if low is not None and (number <= low if parameter.above else number < low):
        return f"must be {'greater than' if parameter.above else 'at least'} {_shown(parameter, low)}"
    if high is not None and (number >= high if parameter.below else number > high):
        return f"must be {'less than' if parameter.below else 'at most'} {_shown(parameter, high)}"
    return None


def check_finite(what: str, expr: Expr, span: Span, context: Context) -> None:
    """Raises SceneError where a component is NaN or infinite."""
    for value, where in samples(expr, context):
        if not all(map(math.isfinite, value.numbers)):
            raise scene_error(f"{what} must be finite{where}", span)
        if max(map(abs, value.numbers)) > LARGEST_NUMBER:
            raise scene_error(f"{what} must be within {LARGEST_NUMBER:g} of zero{where}", span)
