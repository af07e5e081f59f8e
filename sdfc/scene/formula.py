"""The formulas of fields: from the syntax tree to expressions. Numbers have no units here; an angle is in radians."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, cast

from sdfc.diagnostics import InternalError, Span, scene_error
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.scene import functions
from sdfc.scene.bindings import Bindings, did_you_mean
from sdfc.scene.units import UNITS, unknown_unit
from sdfc.shape.definition import ChildFacts, Distance, Kind
from sdfc.syntax import tree

LONGEST_LOOP = 10_000


class Child:
    """A SOLID or PROFILE parameter inside a formula: called at a point, or asked for its facts in a claim."""

    __slots__ = ("distance", "facts", "kind")

    def __init__(self, kind: Kind, distance: Distance | None, facts: ChildFacts | None) -> None:
        self.kind, self.distance, self.facts = kind, distance, facts


Value: TypeAlias = "Expr | tuple[Value, ...] | Child"


class Outer(Protocol):
    """What a formula sees outside of its field."""

    def value(self, name: str, span: Span) -> Expr | None:
        """A named value, or None."""

    def function(self, name: str) -> Helper | None:
        """A function made by `def`, or None."""

    def names(self) -> Sequence[str]:
        """All that there is, for hints."""

    def literal(self, node: tree.Number, number: float) -> Expr | None:
        """The value of a number in the text, where it is more than a constant."""

    def step(self, span: Span) -> None:
        """One more round of a loop, or call: raises SceneError where there are too many."""


@dataclass(frozen=True, slots=True)
class Helper:
    """A `def`, and what it sees itself."""

    declaration: tree.FunctionDeclaration
    outer: Outer


class NothingOutside:
    """An Outer without names."""

    def value(self, name: str, span: Span) -> Expr | None:
        return None

    def function(self, name: str) -> Helper | None:
        return None

    def names(self) -> Sequence[str]:
        return ()

    def literal(self, node: tree.Number, number: float) -> Expr | None:
        return None

    def step(self, span: Span) -> None:
        return None


NOTHING_OUTSIDE = NothingOutside()


class Scope(Bindings[Value]):
    """The names of one formula: local ones, then constants, then what is outside."""

    __slots__ = ("graph", "outer")

    def __init__(
        self,
        graph: FieldGraph,
        values: Mapping[str, Value],
        bindings: Sequence[tree.Binding] = (),
        outer: Outer = NOTHING_OUTSIDE,
        parent: Scope | None = None,
        calls: tuple[str, ...] = (),
    ) -> None:
        super().__init__(values, bindings, parent, calls)
        self.graph = graph
        self.outer = outer

    def compute(self, node: tree.Expression) -> Value:
        return evaluate(node, self)

    def find(self, name: str, span: Span) -> Value:
        """The value of a name."""
        value = self.local(name, span)
        if value is not None:
            return value
        if name in functions.CONSTANTS:
            return self.graph.constant(functions.CONSTANTS[name])
        if name in ("true", "false"):
            return self.graph.boolean(name == "true")
        outside = self.outer.value(name, span)
        if outside is None:
            known = [*functions.CONSTANTS, *self.outer.names(), *self.local_names()]
            raise scene_error(f"unknown name '{name}' in this formula", span, did_you_mean(name, known))
        return outside

    def child(self, name: str) -> Child | None:
        """The child of that name."""
        scope: Bindings[Value] = self
        while scope.parent is not None:
            scope = scope.parent
        value = scope.values.get(name)
        return value if isinstance(value, Child) else None

    def within(self, name: str, value: Value) -> Scope:
        """The same names and one more (a loop's variable)."""
        return Scope(self.graph, {name: value}, (), self.outer, self, self.calls)


def evaluate(node: tree.Expression, scope: Scope) -> Value:
    """The value of an expression."""
    rule = _RULES.get(type(node))
    if rule is None:
        raise InternalError(f"no rule for {type(node).__name__} in a formula")
    return rule(node, scope)


def expression(node: tree.Expression, scope: Scope) -> Expr:
    """The value of an expression that must be a number, a vector or a boolean."""
    value = evaluate(node, scope)
    if isinstance(value, Expr):
        return value
    if isinstance(value, Child):
        raise scene_error("a shape has a value only at a point", node.span, "write it with one, as in shape(p)")
    raise scene_error("expected a number or a vector, not a list", node.span)


def scalar(node: tree.Expression, scope: Scope) -> Expr:
    value = expression(node, scope)
    if value.type is not Type.FLOAT:
        raise scene_error(f"expected a number, not {functions.type_words(value.type)}", node.span)
    return value


def boolean(node: tree.Expression, scope: Scope) -> Expr:
    value = expression(node, scope)
    if value.type is not Type.BOOL:
        raise scene_error(f"expected a condition, not {functions.type_words(value.type)}", node.span)
    return value


def items(value: Value, span: Span) -> tuple[Value, ...]:
    """The elements of a list; a vector is the list of its components."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Expr) and value.type not in (Type.BOOL, Type.FLOAT):
        return tuple([value[i] for i in range(value.type.size)])
    raise scene_error("expected a list", span)


# --- one rule for each kind of node


def _number(node: tree.Number, scope: Scope) -> Value:
    factor = UNITS.get(node.unit)
    if factor is None:
        raise unknown_unit(node)
    live = scope.outer.literal(node, node.value * factor)
    return scope.graph.constant(node.value * factor) if live is None else live


def _name(node: tree.Name, scope: Scope) -> Value:
    value = scope.values.get(node.text)
    return scope.find(node.text, node.span) if value is None else value


def _list(node: tree.ListLiteral, scope: Scope) -> Value:
    values = _elements(node.elements, scope)
    numbers = [v for v in values if isinstance(v, Expr) and v.type is Type.FLOAT]
    return scope.graph.vector(*numbers) if 2 <= len(numbers) == len(values) <= 4 else tuple(values)


def _unary(node: tree.Unary, scope: Scope) -> Value:
    match node.operator:
        case "not":
            return functions.negation(boolean(node.operand, scope))
        case "-":
            return functions.negative(expression(node.operand, scope), node.span)
        case "+":
            return expression(node.operand, scope)
        case other:
            raise scene_error(f"'{other}' is an operator of shapes, not of numbers", node.span)


def _operation(node: tree.Operation, scope: Scope) -> Value:
    operator = node.rest[0].operator
    if operator in ("and", "or"):
        result = boolean(node.first, scope)
        for operand in node.rest:
            result = functions.logic(operator, result, boolean(operand.value, scope))
        return result
    result = expression(node.first, scope)
    for operand in node.rest:
        if operand.operator in "|&":
            raise scene_error(f"'{operand.operator}' is an operator of shapes, not of numbers", operand.operator_span)
        value = expression(operand.value, scope)
        apply = functions.arithmetic if operand.operator in "+-*/" else functions.compare
        result = apply(operand.operator, result, value, node.span)
    return result


def _conditional(node: tree.Conditional, scope: Scope) -> Value:
    condition = boolean(node.condition, scope)
    if condition.is_constant:
        return evaluate(node.then if condition.numbers[0] else node.otherwise, scope)
    then, otherwise = expression(node.then, scope), expression(node.otherwise, scope)
    return functions.choose(condition, then, otherwise, node.span)


def _range(node: tree.Range, scope: Scope) -> Value:
    low, high = scalar(node.low, scope), scalar(node.high, scope)
    if not (low.is_constant and high.is_constant):
        raise scene_error("the ends of a loop must be known when the scene is compiled", node.span)
    count = high.number - low.number
    if not (count <= LONGEST_LOOP and math.isfinite(count)):
        raise scene_error(f"a loop of {count:g} rounds; {LONGEST_LOOP} are allowed", node.span)
    if low.number != round(low.number) or high.number != round(high.number):
        raise scene_error("the ends of a loop must be whole numbers", node.span)
    return tuple([scope.graph.constant(i) for i in range(round(low.number), round(high.number))])


def _call(node: tree.Call, scope: Scope) -> Value:
    name = node.name.text
    if node.block is not None:
        raise scene_error("a formula has no blocks of shapes", node.block.span)
    child = scope.child(name)
    if child is not None:
        return _child_at(node, child, scope)
    helper = scope.outer.function(name)
    if helper is not None:
        return _helped(node, helper, scope)
    for argument in node.arguments:
        if argument.name is not None:
            raise scene_error(f"{name} takes its arguments without names", argument.name.span)
    values = _elements([a.value for a in node.arguments], scope)
    if name == "count" and len(values) == 1:
        return scope.graph.constant(len(items(values[0], node.span)))
    if name not in functions.FUNCTIONS and name not in functions.FOLDS:
        known = [*functions.FUNCTIONS, *functions.FOLDS, "count", *scope.outer.names(), *scope.local_names()]
        raise scene_error(f"unknown function '{name}' in this formula", node.name.span, did_you_mean(name, known))
    if len(values) == 1 and isinstance(values[0], tuple):
        values = list(values[0])  # max(list)
    return functions.call(name, scope.graph, _expressions(values, node.span), node.span)


def _helped(node: tree.Call, helper: Helper, scope: Scope) -> Value:
    """The body of a `def` with these arguments."""
    declaration, name = helper.declaration, node.name.text
    scope.outer.step(node.span)
    scope.check_call(name, node.span)
    parameters = declaration.parameters or ()
    values = dict(zip([p.name.text for p in parameters], _positional(node, scope), strict=False))
    given = sum(1 for a in node.arguments if a.name is None)
    for argument in node.arguments:
        if argument.name is None:
            continue
        if argument.name.text not in [p.name.text for p in parameters] or argument.name.text in values:
            raise scene_error(f"{name} has no further parameter '{argument.name.text}'", argument.name.span)
        values[argument.name.text] = _elements([argument.value], scope)[0]
    if given > len(parameters):
        raise scene_error(f"{name} takes {len(parameters)} arguments, not {given}", node.span)
    inner = Scope(scope.graph, values, declaration.where, helper.outer, None, (*scope.calls, name))
    for parameter in parameters:
        if parameter.name.text not in values:
            if parameter.default is None:
                raise scene_error(f"{name} needs its argument '{parameter.name.text}'", node.span)
            inner.values[parameter.name.text] = evaluate(parameter.default, inner)
    return evaluate(declaration.body, inner)


def _positional(node: tree.Call, scope: Scope) -> list[Value]:
    return _elements([a.value for a in node.arguments if a.name is None], scope)


def _expressions(values: Sequence[Value], span: Span) -> list[Expr]:
    expressions = [value for value in values if isinstance(value, Expr)]
    if len(expressions) < len(values):
        raise scene_error("expected numbers or vectors", span)
    return expressions


def _child_at(node: tree.Call, child: Child, scope: Scope) -> Expr:
    name = node.name.text
    if child.distance is None:
        raise scene_error(f"{name} has no value in a claim: only .lipschitz, .lo and .hi", node.span)
    if len(node.arguments) != 1 or node.arguments[0].name is not None or isinstance(node.arguments[0].value, tree.Loop):
        raise scene_error(f"{name} takes one point, as in {name}(p)", node.span)
    point = expression(node.arguments[0].value, scope)
    wanted = Type.VEC3 if child.kind is Kind.SOLID else Type.VEC2
    if point.type is not wanted:
        where = "space" if child.kind is Kind.SOLID else "the plane"
        words = f"{functions.type_words(wanted)}, not {functions.type_words(point.type)}"
        raise scene_error(f"{name} is a shape in {where}: its point is {words}", node.arguments[0].span)
    return child.distance(point)


def _chain(node: tree.Chain, scope: Scope) -> Value:
    value = evaluate(node.base, scope)
    for link in node.links:
        value = _LINKS[type(link)](value, link, scope)
    return value


def _member(value: Value, link: tree.Member, scope: Scope) -> Value:
    letters = link.name.text
    if isinstance(value, Child):
        if value.facts is None or letters not in ("lo", "hi", "lipschitz"):
            raise scene_error(f"a shape has no '.{letters}' here", link.span)
        return cast("Expr", getattr(value.facts, letters))
    picked = functions.swizzle(value, letters, link.span) if isinstance(value, Expr) else None
    if picked is None:
        raise scene_error(f"there is no '.{letters}' here", link.span, "the parts of a vector are x, y and z")
    return picked


def _index(value: Value, link: tree.Index, scope: Scope) -> Value:
    values = items(value, link.span)
    index = scalar(link.index, scope)
    if not index.is_constant:
        raise scene_error("an index must be known when the scene is compiled", link.span)
    if not 0 <= index.number < len(values) or index.number != round(index.number):
        raise scene_error(f"index {index.number:g} of a list of {len(values)}", link.span, "the first has index 0")
    return values[round(index.number)]


def _method(value: Value, link: tree.Method, scope: Scope) -> Value:
    raise scene_error(f"a formula has no '.{link.name.text}(…)'", link.span)


def _elements(nodes: Sequence[tree.Element], scope: Scope) -> list[Value]:
    """The values that stand in a list or a call, loops expanded."""
    values: list[Value] = []
    for node in nodes:
        if isinstance(node, tree.Loop):
            for item in items(evaluate(node.iterable, scope), node.iterable.span):
                scope.outer.step(node.span)
                values += _elements([node.body], scope.within(node.variable.text, item))
                if len(values) > LONGEST_LOOP:
                    raise scene_error(f"loops of more than {LONGEST_LOOP} values", node.span)
        else:
            values.append(evaluate(node, scope))
    return values


def _not_here(what: str) -> Callable[[Any, Scope], Value]:
    def rule(node: Any, scope: Scope) -> Value:
        raise scene_error(f"{what} has no place in a formula", node.span)

    return rule


_RULES: dict[type, Callable[[Any, Scope], Value]] = {
    tree.Number: _number,
    tree.Name: _name,
    tree.ListLiteral: _list,
    tree.Unary: _unary,
    tree.Operation: _operation,
    tree.Conditional: _conditional,
    tree.Range: _range,
    tree.Call: _call,
    tree.Chain: _chain,
    tree.Text: _not_here("a string"),
    tree.Color: _not_here("a colour"),
}
_LINKS: dict[type, Callable[[Value, Any, Scope], Value]] = {
    tree.Member: _member,
    tree.Method: _method,
    tree.Index: _index,
}
