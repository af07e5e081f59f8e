"""What holds for every shape graph, whoever made it: asked after elaboration, and by tests after every pass."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from sdfc.diagnostics import InternalError
from sdfc.field.graph import Expr, Op, topological
from sdfc.shape.definition import Argument, Kind, Parameter
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.graph import topological as shapes_below

_COMPONENTS = {
    Kind.NUMBER: 1,
    Kind.LENGTH: 1,
    Kind.ANGLE: 1,
    Kind.COUNT: 1,
    Kind.NUMBERS: 1,
    Kind.BOOLEAN: 0,
    Kind.VECTOR2: 2,
    Kind.POINT2: 2,
    Kind.POINTS2: 2,
    Kind.VECTOR3: 3,
    Kind.POINT3: 3,
    Kind.POINTS3: 3,
}
_CHILD_DIMENSIONS = {Kind.SOLID: 3, Kind.PROFILE: 2}


def verify(root: Shape, dimension: int = 3) -> None:
    """Raise InternalError with every broken rule: dimensions, arguments' types, values that are constants or params."""
    broken = [f"{node.span}: {fault}" for node in shapes_below(root) for fault in _faults(node)]
    if root.dimension != dimension:
        broken.append(f"{root.span}: the root has {root.dimension} dimensions, not {dimension}")
    if broken:
        raise InternalError("the shape graph is broken:\n" + "\n".join(broken))


def _faults(node: Shape) -> Iterator[str]:
    match node:
        case Apply():
            yield from _apply_faults(node)
        case Union() | Intersection():
            if not node.children:
                yield "a combination of nothing"
            yield from _dimension_faults(node)
        case Affine():
            yield from _dimension_faults(node)
            for entry in (*node.forward.entries, *node.inverse.entries):
                yield from _value_faults("an affine map's entry", entry, 1)
        case Complement() | Paint():
            yield from _dimension_faults(node)
        case Nothing():
            pass
        case _:
            assert_never(node)


def _dimension_faults(node: Shape) -> Iterator[str]:
    for child in node.children:
        if child.dimension != node.dimension:
            yield f"a child of {child.dimension} dimensions in a node of {node.dimension}"


def _apply_faults(node: Apply) -> Iterator[str]:
    definition = node.definition
    if len(node.children) != len(definition.children) or len(node.arguments) != len(definition.values):
        yield f"{definition.name} has the wrong number of arguments"
        return
    for parameter, child in zip(definition.children, node.children, strict=True):
        if child.dimension != _CHILD_DIMENSIONS[parameter.kind]:
            yield f"{definition.name}'s {parameter.name} is a {parameter.kind.value}, not {child.dimension}-dimensional"
    for parameter, argument in zip(definition.values, node.arguments, strict=True):
        yield from _argument_faults(definition.name, parameter, argument)


def _argument_faults(name: str, parameter: Parameter, argument: Argument) -> Iterator[str]:
    if isinstance(argument, tuple) is not parameter.kind.is_list:
        yield f"{name}'s {parameter.name} is a {parameter.kind.value}"
        return
    for value in argument if isinstance(argument, tuple) else (argument,):
        yield from _value_faults(f"{name}'s {parameter.name}", value, _COMPONENTS[parameter.kind])


def _value_faults(what: str, value: Expr, components: int) -> Iterator[str]:
    if value.type.value != components:
        yield f"{what} has {value.type.value} components, not {components}"
    if any(node.op is Op.INPUT for node in topological([value])):
        yield f"{what} depends on where it is evaluated"
