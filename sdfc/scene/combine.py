"""Unions, intersections, differences and complements: as operators, calls and blocks, sharp, smooth or chamfered."""

from __future__ import annotations

from collections.abc import Sequence

from sdfc.diagnostics import SceneError, Span, scene_error
from sdfc.scene import values
from sdfc.scene.apply import for_children
from sdfc.scene.arguments import Given, check, convert, gather, match
from sdfc.scene.arithmetic import elements
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.library import standard_names
from sdfc.scene.names import Names, Problems
from sdfc.scene.values import ListValue, Value
from sdfc.shape.graph import Shape
from sdfc.syntax import tree

OPERATIONS = ("union", "intersection", "difference")
_OPERATORS = {"|": "union", "&": "intersection", "-": "difference"}
_OPTIONS = ("blend", "chamfer", "kernel")


def call(node: tree.Call, names: Names) -> Value:
    """`union(a, b, for …: c, blend: 0.1, kernel: cubic) { d  e }` and its like."""
    kernel = next((a for a in node.arguments if a.name is not None and a.name.text == "kernel"), None)
    rest = [a for a in node.arguments if a is not kernel]
    given = gather(rest, names)
    options = match(node.name.text, _OPTIONS, [g for g in given if g.name is not None], node.name.span, 0)
    operands = [(g.value, g.span) for g in given if g.name is None]
    if node.block is not None:
        operands += block(node.block, names)
    shapes = flat_shapes(operands)
    style = _style(node, options, kernel, names)
    return _combined(node.name.text, shapes, style, names, node.span)


def block(node: tree.Block, names: Names) -> list[tuple[Value, Span]]:
    """The values of a block's elements, all their errors at once."""
    problems = Problems()
    found: list[tuple[Value, Span]] = []
    for element in node.elements:
        try:
            found += elements([element], names)
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return found


def flat_shapes(operands: Sequence[tuple[Value, Span]], dimension: int | None = None) -> list[Shape]:
    """The operands as shapes, lists opened, all in space or all in the plane."""
    shapes: list[Shape] = []
    problems = Problems()
    pending = list(reversed(operands))
    while pending:
        value, span = pending.pop()
        if isinstance(value, ListValue):
            pending += [(item, span) for item in reversed(value.items)]
            continue
        try:
            shapes.append(values.shape(value, span, dimension))
            dimension = dimension or shapes[0].dimension
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return shapes


def operator(node: tree.Operation, first: Value, rest: Sequence[tuple[str, Span, Value, Span]], names: Names) -> Value:
    """`a | b | c`, `a & b`, `a - b - c`: one node however long."""
    symbol = rest[0][0]
    for other, place, _, _ in rest:
        if other not in _OPERATORS:
            hint = {"+": "write a | b for a union", "*": "write a.scale(…), or a & b"}.get(other)
            raise scene_error(f"'{other}' is an operator of numbers, not of shapes", place, hint)
        if other != symbol:
            raise scene_error(f"'{symbol}' and '{other}' of shapes together need parentheses", place)
    operands = [(first, node.first.span), *[(value, span) for _, _, value, span in rest]]
    return _combined(_OPERATORS[symbol], flat_shapes(operands), None, names, node.span)


def union(shapes: Sequence[Shape], names: Names, span: Span, dimension: int = 3) -> Shape:
    """The union of any number of shapes."""
    return shapes[0] if len(shapes) == 1 else names.context.shapes.union(shapes, span, dimension)


_Style = tuple[str, Given]  # how two shapes are joined ('smooth', 'smooth…cubic', 'chamfer') and the width


def _style(node: tree.Call, options: dict[str, Given], kernel: tree.Argument | None, names: Names) -> _Style | None:
    blend, chamfer = options.get("blend"), options.get("chamfer")
    if blend is not None and chamfer is not None:
        raise scene_error("a blend and a chamfer exclude each other", chamfer.span)
    if kernel is not None and blend is None:
        raise scene_error("a kernel needs a blend", kernel.span, "add blend: 0.1, say")
    if chamfer is not None:
        return "chamfer_{}", chamfer
    if blend is None:
        return None
    kernels = [n.removeprefix("smooth_union_") for n in standard_names() if n.startswith("smooth_union_")]
    if kernel is None:
        return "smooth_{}", blend
    word = kernel.value.text if isinstance(kernel.value, tree.Name) else ""
    if word == "quadratic":
        return "smooth_{}", blend
    if word not in kernels:
        hint = did_you_mean(word, kernels) or "it is quadratic, " + ", ".join(kernels)
        raise scene_error(f"unknown kernel '{word}'", kernel.value.span, hint)
    return f"smooth_{{}}_{word}", blend


def _combined(word: str, shapes: list[Shape], style: _Style | None, names: Names, span: Span) -> Shape:
    if not shapes and word != "union":
        raise scene_error(f"{word} needs at least one shape", span)
    names.context.budget.shape(span)
    graph = names.context.shapes
    if len(shapes) < 2:
        return shapes[0] if shapes else graph.nothing(span)
    if style is None or (style[0].startswith("smooth") and _is_zero(style[1].value)):
        match word:
            case "union":
                return graph.union(shapes, span)
            case "intersection":
                return graph.intersection(shapes, span)
        return graph.difference(shapes[0], shapes[1:], span)
    if word == "difference":
        shapes = [shapes[0], *[graph.complement(s, s.span) for s in shapes[1:]]]
        word = "intersection"
    return _blended(style[0].format(word), shapes, style[1], names, span)


def _is_zero(value: Value) -> bool:
    return isinstance(value, values.Quantity) and value.expr.is_constant and not any(value.expr.numbers)


def _blended(name: str, shapes: Sequence[Shape], width: Given, names: Names, span: Span) -> Shape:
    """Joined two by two, in the order written: smooth minima are not associative."""
    definition = names.context.library.definition(name)
    if definition is None:
        raise scene_error(f"there is no '{name}' in the standard library", span)
    definition = for_children(definition, shapes, names)
    parameter = definition.values[0]
    argument = convert(parameter, width)
    check(parameter, argument, width.span, names.context)
    result = shapes[0]
    for shape in shapes[1:]:
        names.context.budget.shape(span)
        result = names.context.shapes.apply(definition, [argument], [result, shape], span)
    return result


def complement(value: Value, names: Names, operand: Span, span: Span) -> Shape:
    """`~a`."""
    names.context.budget.shape(span)
    return names.context.shapes.complement(values.shape(value, operand), span)
