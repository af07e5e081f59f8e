"""A field tried out with unknown arguments, so that what is wrong in its formula and claims is told where it stands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sdfc.diagnostics import Diagnostic, SceneError
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.scene.define import type_of
from sdfc.shape.definition import Argument, ChildFacts, Definition, Distance, Kind, Parameter

NO_SIZES: Mapping[str, Argument] = MappingProxyType({})


def has_sizes(definition: Definition) -> bool:
    """Whether loops and indices of the formula depend on arguments: lists and counts."""
    return any(p.kind.is_list or p.kind is Kind.COUNT for p in definition.values)


def try_out(definition: Definition, graph: FieldGraph, sizes: Mapping[str, Argument] = NO_SIZES) -> None:
    """Evaluates all that a definition declares; `sizes` are its lists and counts. Raises SceneError with all errors."""
    arguments = {p.name: sizes.get(p.name) or _unknown(p, graph) for p in definition.values}
    point = graph.input("p", Type(definition.dimension))
    children: dict[str, Distance] = {p.name: _distance(p.name, graph) for p in definition.children}
    facts = {p.name: _facts(p, graph) for p in definition.children}
    number = graph.input("level", Type.FLOAT)
    claims = definition.claims
    trials: list[Callable[[], object]] = [lambda: definition.formula(point, arguments, children)]
    trials += [lambda p=p: p.default(arguments) for p in definition.parameters if p.default is not None]  # type: ignore[misc]
    trials += [lambda holds=holds: holds(arguments) for holds, _ in definition.requirements]  # type: ignore[misc]
    if claims.lipschitz is not None:
        lipschitz = claims.lipschitz
        trials.append(lambda: lipschitz(arguments, facts))
    if claims.bounds is not None:
        bounds = claims.bounds
        trials.append(lambda: bounds(arguments, facts, number))
    if claims.gauge is not None:
        gauge = claims.gauge
        trials.append(lambda: gauge(point, arguments))
    if claims.ray is not None:
        ray = claims.ray
        trials.append(lambda: ray(graph.input("o", point.type), graph.input("d", point.type), number, arguments))
    if claims.lowering is not None:
        lowering = claims.lowering
        trials.append(lambda: lowering(arguments))
    problems: list[Diagnostic] = []
    for trial in trials:
        try:
            trial()
        except SceneError as error:
            problems += [d for d in error.diagnostics if d not in problems]
    if problems:
        raise SceneError(*problems)


def _unknown(parameter: Parameter, graph: FieldGraph) -> Argument:
    """Stands for any argument."""
    type_ = type_of(parameter.kind)
    return () if parameter.kind.is_list else graph.input(parameter.name, type_)


def _distance(name: str, graph: FieldGraph) -> Distance:
    def distance(p: Expr) -> Expr:
        return graph.input(f"{name}_at", Type.FLOAT)

    return distance


def _facts(parameter: Parameter, graph: FieldGraph) -> ChildFacts:
    type_ = Type.VEC3 if parameter.kind is Kind.SOLID else Type.VEC2
    name = parameter.name
    return ChildFacts(
        graph.input(f"{name}_lo", type_), graph.input(f"{name}_hi", type_), graph.input(f"{name}_lipschitz", Type.FLOAT)
    )
