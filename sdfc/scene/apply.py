"""Fields and functions called from a scene."""

from __future__ import annotations

from collections.abc import Sequence

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.scene import values
from sdfc.scene.arguments import Given, check, convert, gather, match
from sdfc.scene.check import try_out
from sdfc.scene.define import IN_PLANE
from sdfc.scene.names import Module, Names, Problems, evaluate
from sdfc.scene.ranges import samples
from sdfc.scene.values import Value, is_shape
from sdfc.shape.definition import Argument, Definition, Kind
from sdfc.shape.graph import Shape
from sdfc.syntax import tree


def find(name: str, names: Names) -> Definition | None:
    """The user's or the standard field of that name."""
    return names.module.definition(name) or names.context.library.definition(name)


def for_children(definition: Definition, children: Sequence[Value], names: Names) -> Definition:
    """The definition, or its twin in the plane where an operation on solids is given shapes in the plane."""
    wants_solids = any(p.kind is Kind.SOLID for p in definition.children)
    shapes = [c for c in children if is_shape(c)]
    in_plane = bool(shapes) and all(values.shape(c, definition.span).dimension == 2 for c in shapes)
    if wants_solids and in_plane and definition.dimension == 3:
        try:
            return find(definition.name + IN_PLANE, names) or definition
        except SceneError:  # its formula makes sense in space only
            return definition
    return definition


def apply(
    definition: Definition,
    call: tree.Call | tree.Method,
    names: Names,
    span: Span,
    receiver: Sequence[Given] = (),
    arguments: Sequence[Given] | None = None,
) -> Shape:
    """A field with what it is given: the shape it makes. `receiver` holds the chained shape, or a block's."""
    given = [*receiver, *(gather(call.arguments, names) if arguments is None else arguments)]
    children = definition.children
    order = [p.name for p in (*children, *definition.values) if p.found is None]
    what = definition.name.removesuffix(IN_PLANE)
    matched = match(what, order, given, call.name.span, most_positional=len(children) + 1)
    missing = [p.name for p in definition.parameters if p.default is None and p.name not in matched]
    if missing:
        listed = " and ".join(f"'{name}'" for name in missing)
        raise scene_error(f"{what} needs {listed}", call.name.span, _example(definition, missing))
    definition = for_children(definition, [matched[p.name].value for p in children], names)
    parts = _parts(definition, matched)
    values_ = _values(definition, matched, names, call.name.span)
    names.context.budget.shape(span)
    made = names.context.shapes.apply(definition, values_, parts, span)
    _try(definition, values_, names, span)
    return made


def _example(definition: Definition, missing: Sequence[str]) -> str:
    first = next(p for p in definition.parameters if p.name == missing[0])
    if first.kind.is_child:
        return f"write shape.{definition.name}(…)"
    return f"write {first.name}: …, of kind {first.kind.value}"


def _parts(definition: Definition, matched: dict[str, Given]) -> list[Shape]:
    problems = Problems()
    parts: list[Shape] = []
    for parameter in definition.children:
        given = matched[parameter.name]
        try:
            parts.append(values.shape(given.value, given.span, 3 if parameter.kind is Kind.SOLID else 2))
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return parts


def _values(definition: Definition, matched: dict[str, Given], names: Names, place: Span) -> list[Argument]:
    """Every value parameter in order, defaults filled in; all errors at once."""
    environment: dict[str, Argument] = {}
    problems = Problems()
    for parameter in definition.values:
        given = matched.get(parameter.name)
        try:
            if given is not None:
                environment[parameter.name] = convert(parameter, given)
            elif parameter.default is not None:
                environment[parameter.name] = parameter.default(environment)
            span = place if given is None else given.span
            if parameter.found is None:
                check(parameter, environment[parameter.name], span, names.context)
        except SceneError as error:
            problems.take(error)
    problems.finish()
    _check_requirements(definition, environment, names, place)
    return list(environment.values())


def _check_requirements(definition: Definition, environment: dict[str, Argument], names: Names, place: Span) -> None:
    problems = Problems()
    for holds, message in definition.requirements:
        for value, where in samples(holds(environment), names.context):
            if not value.numbers[0]:
                problems.add(Diagnostic(f"{definition.name.removesuffix(IN_PLANE)}: {message}{where}", place))
                break
    problems.finish()


def _try(definition: Definition, arguments: Sequence[Argument], names: Names, place: Span) -> None:
    """Tries a formula with loops once for each length of a list and each count: a wrong index is told now."""
    pairs = zip(definition.values, arguments, strict=True)
    sizes = {p.name: a for p, a in pairs if p.kind.is_list or p.kind is Kind.COUNT}
    key = (definition, *[len(a) if isinstance(a, tuple) else a for a in sizes.values()])
    if sizes and key not in names.context.tried:
        names.context.tried.add(key)
        try:
            try_out(definition, names.context.graph, sizes)
        except SceneError as error:
            if not definition.is_standard:
                raise
            first = error.diagnostics[0]
            message = f"{definition.name.removesuffix(IN_PLANE)} cannot be made of these: {first.message}"
            raise scene_error(message, place) from None


def expand(
    declared: tuple[tree.FunctionDeclaration, Module],
    call: tree.Call | tree.Method,
    given: Sequence[Given],
    names: Names,
) -> Value:
    """The body of a `def` with what it is given."""
    declaration, module = declared
    name = declaration.name.text
    parameters = declaration.parameters or ()
    matched = match(name, [p.name.text for p in parameters], given, call.name.span)
    missing = [p.name.text for p in parameters if p.default is None and p.name.text not in matched]
    if missing:
        listed = " and ".join(f"'{m}'" for m in missing)
        raise scene_error(f"{name} needs {listed}", call.name.span)
    names.check_call(name, call.span)
    names.context.budget.step(call.span)
    arguments = {key: g.value for key, g in matched.items()}
    inner = Names(names.context, module, arguments, declaration.where, None, (*names.calls, name))
    for parameter in parameters:
        if parameter.default is not None and parameter.name.text not in inner.values:
            inner.values[parameter.name.text] = evaluate(parameter.default, inner)
    return evaluate(declaration.body, inner)
