"""Affine maps in a chain: translate, rotate, scale, mirror, shear, transform. A table: one row each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from sdfc.diagnostics import Span, scene_error
from sdfc.field.graph import Expr, FieldGraph, Op, Operand
from sdfc.scene import values
from sdfc.scene.arguments import Given, check_finite, gather, match
from sdfc.scene.names import Names
from sdfc.scene.ranges import samples, zero
from sdfc.shape import matrix
from sdfc.shape.graph import Shape
from sdfc.shape.matrix import Matrix
from sdfc.syntax import tree

_AXES = ("x", "y", "z")
_Arguments = Mapping[str, Given]
_Build = Callable[[_Arguments, int, Names, Span], "tuple[Matrix, Matrix]"]


def transform(receiver: Shape, link: tree.Method, names: Names, span: Span) -> Shape:
    """The receiver moved as the link says."""
    name = link.name.text
    parameters, build = TRANSFORMS[name]
    given = match(name, parameters, gather(link.arguments, names), link.name.span, 1)
    if not given:
        raise scene_error(f"{name} needs an argument", link.name.span, "it has " + ", ".join(parameters))
    forward, inverse = build(given, receiver.dimension, names, link.span)
    for entry in dict.fromkeys(forward.entries):  # most are the same 0 and 1
        check_finite(name, entry, link.span, names.context)
    names.context.budget.shape(span)
    return names.context.shapes.affine(forward, inverse, receiver, span)


def _only(given: _Arguments, allowed: Sequence[str], what: str) -> None:
    """Nothing beside the `allowed` ones."""
    for name, argument in given.items():
        if name not in allowed:
            raise scene_error(f"{what} goes without '{name}'", argument.span)


def _components(given: _Arguments, dimension: int, default: float, names: Names) -> list[Expr]:
    """x:, y: and z: as three numbers."""
    graph = names.context.graph
    parts = [graph.constant(default)] * 3
    for axis, name in enumerate(_AXES):
        if name in given:
            _check_axis(axis, dimension, given[name].span)
            parts[axis] = values.number(given[name].value, given[name].span)
    return parts


def _check_axis(axis: int, dimension: int, span: Span) -> None:
    if axis == 2 and dimension == 2:
        raise scene_error("a shape in the plane has no z", span)


def _padded(vector: Expr, last: Operand) -> list[Expr]:
    """Three components, the third of a plane vector being `last`."""
    parts = [vector[i] for i in range(vector.type.size)]
    return parts if len(parts) == 3 else [*parts, vector.graph.lift(last)]


def _vector(given: Given, dimension: int, last: Operand, spread: bool = False) -> list[Expr]:
    return _padded(values.vector(given.value, dimension, given.span, spread), last)


def _translate(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    graph = names.context.graph
    if "by" in given:
        _only(given, ("by",), "a translation by a vector")
        x, y, z = _vector(given["by"], dimension, 0.0)
    else:
        x, y, z = _components(given, dimension, 0.0, names)
    return matrix.translation(graph, x, y, z), matrix.translation(graph, -x, -y, -z)


def _scale(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    graph = names.context.graph
    if "by" in given:
        _only(given, ("by",), "a scale by a number or vector")
        parts = _vector(given["by"], dimension, 1.0, spread=True)
        if dimension == 2 and not _is_vector(given["by"]):
            parts[2] = graph.constant(1.0)
    else:
        parts = _components(given, dimension, 1.0, names)
    for axis, part in enumerate(parts):
        where = zero(part, names.context)
        if where is not None:
            raise scene_error(f"scale by 0 along {_AXES[axis]}{where} leaves nothing", span)
    x, y, z = parts
    return matrix.scaling(graph, x, y, z), matrix.scaling(graph, 1.0 / x, 1.0 / y, 1.0 / z)


def _is_vector(given: Given) -> bool:
    return isinstance(given.value, values.Quantity) and given.value.expr.type.size > 1


def _rotate(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    graph = names.context.graph
    if "angle" in given:
        _only(given, ("angle", "axis"), "a rotation by an angle about an axis")
        turned = _about_axis(given, dimension, graph, names, span)
        return turned, matrix.transposed(turned)
    if "axis" in given:
        raise scene_error("a rotation about an axis needs an angle", span, "add angle: 30deg, say")
    result = matrix.identity(graph)
    for axis, name in enumerate(_AXES):
        if name in given:
            if dimension == 2 and axis != 2:
                raise scene_error("a shape in the plane turns about z only", given[name].span, "write rotate(30deg)")
            angle = values.angle(given[name].value, given[name].span)
            result = _snapped(matrix.rotation(graph, axis, angle)).after(result)
    return result, matrix.transposed(result)


def _about_axis(given: _Arguments, dimension: int, graph: FieldGraph, names: Names, span: Span) -> Matrix:
    angle = values.angle(given["angle"].value, given["angle"].span)
    if "axis" not in given:
        if dimension == 3:
            hint = "write rotate(y: …), or rotate(angle, axis: […])"
            raise scene_error("about which axis?", given["angle"].span, hint)
        return _snapped(matrix.rotation(graph, 2, angle))
    if dimension == 2:
        raise scene_error("a shape in the plane turns about z only", given["axis"].span, "write rotate(30deg)")
    axis = _unit(given["axis"], 3, names)
    c, s = graph.add(Op.COS, angle), graph.add(Op.SIN, angle)
    x, y, z = axis
    rest = 1.0 - c
    rows: list[list[Operand]] = [
        [c + x * x * rest, x * y * rest - z * s, x * z * rest + y * s],
        [y * x * rest + z * s, c + y * y * rest, y * z * rest - x * s],
        [z * x * rest - y * s, z * y * rest + x * s, c + z * z * rest],
    ]
    return _snapped(matrix.matrix(graph, rows, [0.0, 0.0, 0.0]))


def _unit(given: Given, dimension: int, names: Names) -> list[Expr]:
    """A direction of length 1."""
    vector = values.vector(given.value, dimension, given.span)
    for value, where in samples(vector, names.context):
        if not any(value.numbers):
            raise scene_error(f"a direction cannot be zero{where}", given.span)
    return _padded(vector / vector.graph.length(vector), 0.0)


def _snapped(turn: Matrix) -> Matrix:
    """A quarter turn is exact: what the rounding of pi leaves of its zeros would tilt flush faces."""

    def exact(entry: Expr) -> Expr:
        if not entry.is_constant or not math.isfinite(entry.number):
            return entry
        nearest = float(round(entry.number))
        return entry.graph.constant(nearest) if abs(entry.number - nearest) < 4e-16 else entry

    rows = [(exact(a), exact(b), exact(c)) for a, b, c in turn.linear]
    return Matrix((rows[0], rows[1], rows[2]), turn.offset)


def _mirror(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    graph = names.context.graph
    if "normal" in given:
        _only(given, ("normal",), "a mirror with a normal")
        n = _unit(given["normal"], dimension, names)
        rows: list[list[Operand]] = [[float(i == j) - 2.0 * n[i] * n[j] for j in range(3)] for i in range(3)]
        reflected = _snapped(matrix.matrix(graph, rows, [0.0, 0.0, 0.0]))
        return reflected, reflected
    parts = [1.0, 1.0, 1.0]
    for axis, name in enumerate(_AXES):
        if name in given:
            _check_axis(axis, dimension, given[name].span)
            flag = values.boolean(given[name].value, given[name].span)
            if values.constant(flag, "a mirror", given[name].span).numbers[0]:
                parts[axis] = -1.0
    reflected = matrix.scaling(graph, *parts)
    return reflected, reflected


_SHEARS = ("xy", "xz", "yx", "yz", "zx", "zy")


def _shear(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    rows: list[list[Operand]] = [[float(i == j) for j in range(3)] for i in range(3)]
    for name, argument in given.items():
        target, source = "xyz".index(name[0]), "xyz".index(name[1])
        _check_axis(max(target, source), dimension, argument.span)
        rows[target][source] = values.number(argument.value, argument.span)
    return _inverted(matrix.matrix(names.context.graph, rows, [0.0, 0.0, 0.0]), names, span)


def _transform(given: _Arguments, dimension: int, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    if "rows" not in given:
        raise scene_error("transform needs 'rows'", span, "write rows: [[…], […], […]]")
    place = given["rows"].span
    found = values.items(given["rows"].value, place)
    table = [values.items(row, place) for row in found]
    widths = {len(row) for row in table}
    if len(table) != dimension or not widths <= {dimension, dimension + 1} or len(widths) != 1:
        raise scene_error(
            f"rows are {dimension} lists of {dimension} numbers, or of {dimension + 1} with the offset last", place
        )
    numbers = [[values.number(entry, place) for entry in row] for row in table]
    rows: list[list[Operand]] = [[float(i == j) for j in range(3)] for i in range(3)]
    offset: list[Operand] = [0.0, 0.0, 0.0]
    for i, row in enumerate(numbers):
        rows[i][:dimension] = row[:dimension]
        offset[i] = row[dimension] if len(row) > dimension else 0.0
    if "offset" in given:
        offset = list(_vector(given["offset"], dimension, 0.0))
    return _inverted(matrix.matrix(names.context.graph, rows, offset), names, span)


def _inverted(forward: Matrix, names: Names, span: Span) -> tuple[Matrix, Matrix]:
    """With the inverse; raises SceneError where there is none."""
    graph = names.context.graph
    a, b, c = (graph.vector(*row) for row in forward.linear)
    size = graph.length(a) * graph.length(b) * graph.length(c)
    where = zero(graph.dot(a, graph.cross(b, c)) / size, names.context, 1e-12)
    if where is not None:
        raise scene_error(f"this transform is singular{where}: it flattens the shape", span)
    return forward, matrix.inverse(forward)


TRANSFORMS: Mapping[str, tuple[tuple[str, ...], _Build]] = MappingProxyType(
    {
        "translate": (("by", *_AXES), _translate),
        "rotate": (("angle", *_AXES, "axis"), _rotate),
        "scale": (("by", *_AXES), _scale),
        "mirror": (("normal", *_AXES), _mirror),
        "shear": (_SHEARS, _shear),
        "transform": (("rows", "offset"), _transform),
    }
)
