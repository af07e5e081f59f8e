"""Operators, calls and chains: which rule a name stands for."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.scene import arithmetic, combine, functions, settings, values
from sdfc.scene.apply import apply, expand, find
from sdfc.scene.arguments import Given, gather, match
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.library import standard_names
from sdfc.scene.names import Names, Problems, Rule, evaluate
from sdfc.scene.transforms import TRANSFORMS, transform
from sdfc.scene.values import Value, is_shape, words
from sdfc.shape.definition import Kind
from sdfc.shape.graph import Shape
from sdfc.shape.material import Material
from sdfc.syntax import tree

# --- operators


def _unary(node: tree.Unary, names: Names) -> Value:
    value = evaluate(node.operand, names)
    match node.operator:
        case "not":
            return values.Quantity(functions.negation(values.boolean(value, node.operand.span)))
        case "~":
            return combine.complement(value, names, node.operand.span, node.span)
    if is_shape(value):
        raise scene_error("'-' needs a shape before it, too", node.span, "write ~a for the complement")
    return arithmetic.sign(node, value)


def _operation(node: tree.Operation, names: Names) -> Value:
    if node.rest[0].operator in ("and", "or"):
        return arithmetic.logic(node, names)
    first, rest = _operands(node, names)
    if is_shape(first) or any(is_shape(value) for _, _, value, _ in rest) or node.rest[0].operator in "|&":
        return combine.operator(node, first, rest, names)
    result = values.quantity(first, node.first.span)
    for symbol, place, value, span in rest:
        result = arithmetic.calculate(symbol, result, values.quantity(value, span), place, node.span)
    return result


def _operands(node: tree.Operation, names: Names) -> tuple[Value, list[tuple[str, Span, Value, Span]]]:
    """The values of all operands, each of the others with its operator; all their errors at once."""
    problems = Problems()
    found: list[Value] = []
    for operand in (node.first, *[o.value for o in node.rest]):
        names.context.budget.step(operand.span)
        try:
            found.append(evaluate(operand, names))
        except SceneError as error:
            problems.take(error)
    problems.finish()
    pairs = zip(node.rest, found[1:], strict=True)
    return found[0], [(o.operator, o.operator_span, value, o.value.span) for o, value in pairs]


# --- calls


def _call(node: tree.Call, names: Names) -> Value:
    name = node.name.text
    special = _SPECIAL.get(name)
    if special is not None:
        return special(node, names)
    declared = names.module.function(name)
    if declared is not None:
        _no_block(node)
        return expand(declared, node, gather(node.arguments, names), names)
    definition = names.module.definition(name)
    given: list[Given] | None = None
    if definition is None and arithmetic.is_function(name) and node.block is None:  # `round` is also an operation
        given = gather(node.arguments, names)
        if not given or not is_shape(given[0].value):
            return _function(name, given, names, node)
    definition = definition or names.context.library.definition(name)
    if definition is None:
        raise _unknown_call(node, names)
    receiver: Sequence[Given] = ()
    if node.block is not None:
        receiver = _block_children(node.block, [p.name for p in definition.children], names, node)
    return apply(definition, node, names, node.span, receiver, given)


def _no_block(node: tree.Call) -> None:
    if node.block is not None:
        raise scene_error(f"{node.name.text} takes no block of shapes", node.block.span, "write its arguments in (…)")


def _function(name: str, given: Sequence[Given], names: Names, node: tree.Call) -> Value:
    for argument in given:
        if argument.name is not None:
            raise scene_error(f"{name} takes its arguments without names", argument.name.span)
    return arithmetic.function(name, [(g.value, g.span) for g in given], names, node.span)


def _block_children(block: tree.Block, children: Sequence[str], names: Names, node: tree.Call) -> list[Given]:
    """What a block gives to an operation: as many shapes as it has children; to one child, their union."""
    if not children:
        raise scene_error(f"{node.name.text} takes no block of shapes", block.span, "join shapes with union { … }")
    shapes = combine.flat_shapes(combine.block(block, names))
    if len(children) == 1:
        return [Given(combine.union(shapes, names, block.span), block.span)]
    if len(shapes) != len(children):
        raise scene_error(f"{node.name.text} takes {len(children)} shapes, not {len(shapes)}", block.span)
    return [Given(shape, shape.span) for shape in shapes]


def _unknown_call(node: tree.Call, names: Names) -> SceneError:
    name = node.name.text
    if name in _CHAINED:
        return scene_error(f"'{name}' is written behind a shape", node.name.span, f"write shape.{name}(…)")
    if names.local(name, node.span) is not None or names.module.value(name, node.span) is not None:
        return scene_error(f"'{name}' is a value and cannot be called", node.name.span)
    known = [*standard_names(), *names.module.names(), *functions.FUNCTIONS, *functions.FOLDS, *_SPECIAL]
    return scene_error(f"unknown shape or function '{name}'", node.name.span, did_you_mean(name, known))


def _checker(node: tree.Call, names: Names) -> Value:
    given = match("checker", ("first", "second", "scale"), gather(node.arguments, names), node.name.span, 2)
    if "first" not in given:
        raise scene_error("checker needs two colours", node.name.span)
    message = "textures are not there yet: this is its first colour"
    names.context.warnings.append(Diagnostic(message, node.span, severity="warning"))
    return given["first"].value


def _instances(node: tree.Call, names: Names) -> Value:
    """`instances("file.csv", shape of row)`: the union over the rows of a table."""
    if len(node.arguments) != 2 or any(a.name is not None for a in node.arguments):
        example = 'write instances("file.csv", sphere(radius: row.r))'
        raise scene_error("instances takes a file and a shape", node.name.span, example)
    path, body = (a.value for a in node.arguments)
    if not isinstance(path, tree.Text):
        raise scene_error("the file's name is a string", path.span)
    found: list[tuple[Value, Span]] = []
    for row in names.module.table(path.value, path.span):
        names.context.budget.step(node.span)
        found += _instance(body, row, names)
    return combine.union(combine.flat_shapes(found), names, node.span)


def _instance(body: tree.Element, row: Value, names: Names) -> list[tuple[Value, Span]]:
    """What one row makes; an error says also which row it is."""
    try:
        return arithmetic.elements([body], names.within("row", row))
    except SceneError as error:
        assert isinstance(row, values.Row)
        hint = f"in the row at {row.span}"
        raise SceneError(*[d if d.hint else dataclasses.replace(d, hint=hint) for d in error.diagnostics]) from None


_SPECIAL: Mapping[str, Callable[[tree.Call, Names], Value]] = MappingProxyType(
    {**dict.fromkeys(combine.OPERATIONS, combine.call), "checker": _checker, "instances": _instances}
)

# --- chains


def _chain(node: tree.Chain, names: Names) -> Value:
    value = evaluate(node.base, names)
    for link in node.links:
        value = _LINKS[type(link)](value, link, names, Span(node.span.source, node.span.start, link.span.end))
    return value


def _member(value: Value, link: tree.Member, names: Names, span: Span) -> Value:
    if is_shape(value):
        name = link.name.text
        raise scene_error(f"a shape has no '.{name}'", link.span, f"write .{name}(…) to call it")
    return arithmetic.member(value, link, names)


def _index(value: Value, link: tree.Index, names: Names, span: Span) -> Value:
    return arithmetic.index(value, link, names)


def _method(value: Value, link: tree.Method, names: Names, span: Span) -> Value:
    name = link.name.text
    receiver_span = Span(span.source, span.start, link.span.start)
    declared = names.module.function(name)
    if declared is not None:
        return expand(declared, link, [Given(value, receiver_span), *gather(link.arguments, names)], names)
    if not is_shape(value):
        raise scene_error(f"'.{name}(…)' needs a shape before it, not {words(value)}", link.name.span)
    receiver = values.shape(value, receiver_span)
    builtin = _CHAINED.get(name)
    if builtin is not None:
        return builtin(receiver, link, names, span)
    definition = find(name, names)
    if definition is None:
        raise _unknown_method(name, link, names)
    if definition.is_primitive:
        raise scene_error(f"{name} is a shape of its own, not an operation", link.name.span, f"write … | {name}(…)")
    return apply(definition, link, names, span, [Given(receiver, receiver_span)])


def _unknown_method(name: str, link: tree.Method, names: Names) -> SceneError:
    if name in combine.OPERATIONS:
        return scene_error(f"'{name}' is not chained", link.name.span, f"write {name}(a, b), or an operator | & -")
    operations = [n for n in standard_names() if _is_operation(n, names)] if len(name) < 40 else []
    hint = did_you_mean(name, [*_CHAINED, *operations, *names.module.names()])
    return scene_error(f"unknown operation '{name}'", link.name.span, hint)


def _is_operation(name: str, names: Names) -> bool:
    definition = names.context.library.definition(name)
    return definition is not None and any(p.kind in (Kind.SOLID, Kind.PROFILE) for p in definition.parameters)


def _paint(receiver: Shape, link: tree.Method, names: Names, span: Span) -> Shape:
    given = gather(link.arguments, names)
    if len(given) == 1 and given[0].name is None:
        if not isinstance(given[0].value, Material):
            message = f"expected a material, not {words(given[0].value)}"
            raise scene_error(message, given[0].span, "write .material(color: …), or declare a material")
        painted = given[0].value
    else:
        painted = settings.material("", given, names, link.span)
    names.context.budget.shape(span)
    return names.context.shapes.paint(painted, receiver, span)


_CHAINED: Mapping[str, Callable[[Shape, tree.Method, Names, Span], Shape]] = MappingProxyType(
    {**dict.fromkeys(TRANSFORMS, transform), "material": _paint}
)
_LINKS: Mapping[type, Callable[[Value, Any, Names, Span], Value]] = MappingProxyType(
    {tree.Member: _member, tree.Method: _method, tree.Index: _index}
)

RULES: Mapping[type, Rule] = MappingProxyType(
    {
        **arithmetic.RULES,
        tree.Unary: _unary,
        tree.Operation: _operation,
        tree.Call: _call,
        tree.Chain: _chain,
    }
)

# what no declaration can take away
BUILT_IN = frozenset(
    {*_SPECIAL, *_CHAINED, *functions.FUNCTIONS, *functions.FOLDS, *functions.CONSTANTS}
    | {"count", "true", "false", "nothing", "row"}
) - {"round"}
