"""Expressions of numbers, vectors, colours, booleans and lists, with their units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from sdfc.diagnostics import Span, scene_error
from sdfc.field.graph import Expr, Type
from sdfc.scene import functions, values
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.color import hexadecimal
from sdfc.scene.limits import LONGEST_LOOP
from sdfc.scene.literals import literal
from sdfc.scene.names import Names, Rule, evaluate
from sdfc.scene.units import UNITS, unknown_unit
from sdfc.scene.values import ListValue, Quantity, RangeValue, Unit, Value, words
from sdfc.syntax import tree


def _number(node: tree.Number, names: Names) -> Value:
    factor = UNITS.get(node.unit)
    if factor is None:
        raise unknown_unit(node)
    unit = Unit.ANGLE if node.unit else Unit.NUMBER
    number, context = node.value * factor, names.context
    live = literal(node, (number,), unit, context) if context.literals else None
    return Quantity(live or context.graph.constant(number), unit)


def _color(node: tree.Color, names: Names) -> Value:
    numbers = hexadecimal(node)
    live = literal(node, numbers, Unit.COLOR, names.context)
    return Quantity(names.context.graph.constant(*numbers) if live is None else live, Unit.COLOR)


def _text(node: tree.Text, names: Names) -> Value:
    return values.TextValue(node.value)


def _name(node: tree.Name, names: Names) -> Value:
    return names.find(node.text, node.span)


def _list(node: tree.ListLiteral, names: Names) -> Value:
    found = [value for value, _ in elements(node.elements, names)]
    scalars = [v for v in found if isinstance(v, Quantity) and v.expr.type is Type.FLOAT]
    if not 2 <= len(scalars) == len(found) <= 4:
        return ListValue(tuple(found))
    units = {v.unit for v in scalars}
    if len(units) > 1:
        raise scene_error("a vector cannot mix numbers and angles", node.span)
    return Quantity(names.context.graph.vector(*[v.expr for v in scalars]), scalars[0].unit)


def elements(nodes: Sequence[tree.Element], names: Names) -> list[tuple[Value, Span]]:
    """The values that stand in a list, a call or a block, loops expanded, with their places."""
    found: list[tuple[Value, Span]] = []
    for node in nodes:
        if isinstance(node, tree.Loop):
            for item in rounds(evaluate(node.iterable, names), node.iterable.span):
                names.context.budget.step(node.span)
                found += elements([node.body], names.within(node.variable.text, item))
        else:
            found.append((evaluate(node, names), node.span))
    return found


def rounds(value: Value, span: Span) -> tuple[Value, ...]:
    """What a loop's variable becomes, one after the other. The end of a range is not among it."""
    if not isinstance(value, RangeValue):
        return values.items(value, span)
    ends = [values.constant(values.number(end, span), "the end of a loop", span) for end in (value.low, value.high)]
    low, high = ends
    start, stop = low.number, high.number
    if not (stop - start <= LONGEST_LOOP and math.isfinite(stop - start)):
        raise scene_error(f"a loop of {stop - start:g} rounds; {LONGEST_LOOP} are allowed", span)
    if start != round(start) or stop != round(stop):
        raise scene_error("the ends of a loop must be whole numbers", span)
    if stop < start:
        raise scene_error(f"the range {start:g}..{stop:g} is empty", span, "the smaller number comes first")
    return tuple([Quantity(low.graph.constant(i)) for i in range(round(start), round(stop))])


# --- operators of numbers


def sign(node: tree.Unary, value: Value) -> Value:
    """`-a`, `+a`."""
    operand = values.quantity(value, node.operand.span)
    result = functions.negative(operand.expr, node.span)
    return Quantity(result, operand.unit) if node.operator == "-" else operand


def calculate(operator: str, a: Quantity, b: Quantity, place: Span, whole: Span) -> Quantity:
    """`a operator b`, for + - * / and comparisons."""
    if operator in "+-*/":
        unit = _unit_of(operator, a, b, place)
        return Quantity(functions.arithmetic(operator, a.expr, b.expr, whole), unit)
    if a.unit is not b.unit:
        raise scene_error(f"'{operator}' cannot compare {words(a)} with {words(b)}", place)
    return Quantity(functions.compare(operator, a.expr, b.expr, whole))


def _unit_of(operator: str, a: Quantity, b: Quantity, place: Span) -> Unit:
    units = {a.unit, b.unit}
    if Unit.ANGLE not in units:
        return Unit.COLOR if Unit.COLOR in units else Unit.NUMBER
    if operator in "+-":
        if len(units) == 1:
            return Unit.ANGLE
        bare = a.expr if a.unit is Unit.NUMBER else b.expr
        known = bare.is_constant and bare.type is Type.FLOAT
        hint = f"write {bare.number:g}deg" if known else "an angle has a unit, as in 30deg"
        raise scene_error(f"'{operator}' cannot mix {words(a)} and {words(b)}", place, hint)
    if Unit.COLOR not in units and not (operator == "*" and len(units) == 1):
        if operator == "/" and b.unit is Unit.ANGLE:
            if a.unit is Unit.ANGLE:
                return Unit.NUMBER
            raise scene_error(f"cannot divide {words(a)} by an angle", place)
        return Unit.ANGLE
    raise scene_error(f"'{operator}' cannot mix {words(a)} and {words(b)}", place)


def logic(node: tree.Operation, names: Names) -> Value:
    """`a and b and c`, `a or b`; what a constant already decides is not evaluated further."""
    operator = node.rest[0].operator
    decided = 1.0 if operator == "or" else 0.0
    result = values.boolean(evaluate(node.first, names), node.first.span)
    for operand in node.rest:
        if result.is_constant and result.numbers[0] == decided:
            break
        result = functions.logic(operator, result, values.boolean(evaluate(operand.value, names), operand.value.span))
    return Quantity(result)


def _conditional(node: tree.Conditional, names: Names) -> Value:
    condition = values.boolean(evaluate(node.condition, names), node.condition.span)
    if condition.is_constant:
        return evaluate(node.then if condition.numbers[0] else node.otherwise, names)
    then, otherwise = evaluate(node.then, names), evaluate(node.otherwise, names)
    if not isinstance(then, Quantity) or not isinstance(otherwise, Quantity):
        raise scene_error(
            f"a param can choose between numbers and vectors, not {words(then)}",
            node.span,
            "the shapes of a scene are fixed when it is compiled; only their numbers are live",
        )
    if then.unit is not otherwise.unit:
        raise scene_error(f"'if' cannot choose between {words(then)} and {words(otherwise)}", node.span)
    return Quantity(functions.choose(condition, then.expr, otherwise.expr, node.span), then.unit)


def _range(node: tree.Range, names: Names) -> Value:
    low = values.quantity(evaluate(node.low, names), node.low.span)
    high = values.quantity(evaluate(node.high, names), node.high.span)
    if low.unit is not high.unit or Type.BOOL in (low.expr.type, high.expr.type):
        raise scene_error(f"a range cannot go from {words(low)} to {words(high)}", node.span)
    return RangeValue(low, high)


# --- functions of numbers


def is_function(name: str) -> bool:
    return name in functions.FUNCTIONS or name in functions.FOLDS or name == "count"


def function(name: str, arguments: Sequence[tuple[Value, Span]], names: Names, span: Span) -> Value:
    """A GLSL function, `sum`, `product` or `count` of values."""
    if name == "count":
        if len(arguments) != 1:
            raise scene_error(f"count takes 1 argument, not {len(arguments)}", span)
        return Quantity(names.context.graph.constant(len(values.items(*arguments[0]))))
    if len(arguments) == 1 and isinstance(arguments[0][0], ListValue):
        arguments = [(item, arguments[0][1]) for item in arguments[0][0].items]  # max(list)
    quantities = [values.quantity(value, place) for value, place in arguments]
    unit = _function_unit(name, quantities, [place for _, place in arguments], span)
    exprs: list[Expr] = [q.expr for q in quantities]
    return Quantity(functions.call(name, names.context.graph, exprs, span), unit)


def _function_unit(name: str, quantities: Sequence[Quantity], places: Sequence[Span], span: Span) -> Unit:
    row = functions.FUNCTIONS.get(name)
    units = {q.unit for q in quantities[:2] if name == "mix"} or {q.unit for q in quantities}
    if (row is not None and row.keeps_unit) or name == "sum":
        if Unit.ANGLE in units and len(units) > 1:
            raise scene_error(f"{name} cannot mix angles and numbers", span)
        return Unit.COLOR if Unit.COLOR in units else next(iter(units), Unit.NUMBER)
    if row is None or not row.takes_angle:
        for value, place in zip(quantities, places, strict=True):
            if value.unit is Unit.ANGLE and name not in ("sign", "length"):
                raise scene_error(f"{name} takes numbers, not {words(value)}", place)
    return Unit.ANGLE if row is not None and row.gives_angle else Unit.NUMBER


# --- parts of values


def member(value: Value, link: tree.Member, names: Names) -> Value:
    """`vector.xy`, `color.r`, `row.column`."""
    letters = link.name.text
    if isinstance(value, values.Row):
        return cell(value, link, names)
    if not isinstance(value, Quantity):
        raise scene_error(f"{words(value)} has no '.{letters}'", link.span, f"write .{letters}(…) to call it")
    picked = functions.swizzle(value.expr, letters, link.span)
    if picked is None:
        raise scene_error(f"{words(value)} has no '.{letters}'", link.span, "the parts of a vector are x, y and z")
    whole_color = value.unit is Unit.COLOR and len(letters) == 3
    return Quantity(picked, Unit.NUMBER if value.unit is Unit.COLOR and not whole_color else value.unit)


def cell(row: values.Row, link: tree.Member, names: Names) -> Value:
    """A cell of a table as a number, with its unit if one stands behind it."""
    column = link.name.text
    text = row.cells.get(column)
    if text is None:
        hint = did_you_mean(column, list(row.cells)) or "the columns are " + ", ".join(row.cells)
        raise scene_error(f"the table {row.source.name} has no column '{column}'", link.span, hint)
    number = text.strip()
    digits = number.rstrip("degra") if number[-3:] in ("deg", "rad") else number
    unit = number[len(digits) :]
    try:
        value = float(digits)
    except ValueError:
        value = float("nan")
    if unit not in UNITS or not abs(value) < float("inf"):
        raise scene_error(f"'{text}' in column '{column}' is not a number", row.span, "this is the row of the table")
    return Quantity(names.context.graph.constant(value * UNITS[unit]), Unit.ANGLE if unit else Unit.NUMBER)


def index(value: Value, link: tree.Index, names: Names) -> Value:
    """`list[i]`, `vector[i]`."""
    found = values.items(value, link.span)
    at = values.number(evaluate(link.index, names), link.index.span)
    position = values.constant(at, "an index", link.index.span).number
    if not 0 <= position < len(found) or position != round(position):
        raise scene_error(f"index {position:g} of a list of {len(found)}", link.span, "the first has index 0")
    return found[round(position)]


RULES: Mapping[type[Any], Rule] = MappingProxyType(
    {
        tree.Number: _number,
        tree.Color: _color,
        tree.Text: _text,
        tree.Name: _name,
        tree.ListLiteral: _list,
        tree.Conditional: _conditional,
        tree.Range: _range,
    }
)
