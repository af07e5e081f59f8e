"""Materials, the camera, lights and the sky: braces with properties, each checked against a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.field.graph import Expr, FieldGraph
from sdfc.scene import values
from sdfc.scene.arguments import Given, match
from sdfc.scene.color import linear
from sdfc.scene.limits import LARGEST_NUMBER
from sdfc.scene.model import Camera, Light, PointLight, Sky, Sun
from sdfc.scene.names import Names, Problems, evaluate
from sdfc.scene.ranges import samples
from sdfc.scene.values import Value
from sdfc.shape.material import Material
from sdfc.syntax import tree


@dataclass(frozen=True, slots=True)
class _Row:
    """A property: how it is read, its default, and the limits of each component (the upper one may be excluded)."""

    read: Callable[[Value, Span], Expr]
    default: tuple[float, ...] | None
    low: float = -math.inf
    high: float = math.inf
    open: bool = False  # whether the limits themselves are excluded
    degrees: bool = False


def _gray(byte: int) -> tuple[float, float, float]:
    return (linear(byte / 255),) * 3


def _rgb(digits: str) -> tuple[float, float, float]:
    red, green, blue = (linear(int(digits[i : i + 2], 16) / 255) for i in (0, 2, 4))
    return red, green, blue


def _point(value: Value, span: Span) -> Expr:
    return values.vector(value, 3, span)


def _number(value: Value, span: Span) -> Expr:
    return values.number(value, span)


_MATERIAL = MappingProxyType(
    {
        "color": _Row(values.color, _gray(0xB8), 0.0),
        "metallic": _Row(_number, (0.0,), 0.0, 1.0),
        "roughness": _Row(_number, (0.5,), 0.0, 1.0),
        "emission": _Row(values.color, (0.0, 0.0, 0.0), 0.0),
        "transmission": _Row(_number, (0.0,), 0.0, 1.0),
        "ior": _Row(_number, (1.5,), 1.0, 10.0),
        "tint": _Row(values.color, (1.0, 1.0, 1.0), 0.0),
    }
)
_CAMERA = MappingProxyType(
    {
        "eye": _Row(_point, None),
        "target": _Row(_point, (0.0, 0.0, 0.0)),
        "up": _Row(_point, (0.0, 1.0, 0.0)),
        "fov": _Row(values.angle, (math.radians(40.0),), 0.0, math.pi, open=True, degrees=True),
        "height": _Row(_number, None, 0.0, open=True),
    }
)
_LIGHT = MappingProxyType(
    {
        "direction": _Row(_point, None),
        "position": _Row(_point, None),
        "color": _Row(values.color, (1.0, 1.0, 1.0), 0.0),
        "intensity": _Row(_number, (3.0,), 0.0),
    }
)
_SKY = MappingProxyType(
    {
        "zenith": _Row(values.color, _rgb("6f9fd8"), 0.0),
        "horizon": _Row(values.color, _rgb("e8f0ff"), 0.0),
        "ground": _Row(values.color, _rgb("6b665e"), 0.0),
    }
)


def material(name: str, given: Sequence[Given], names: Names, span: Span) -> Material:
    """A material from its properties; what is not said has its default."""
    read = _read("a material", _MATERIAL, given, names, span)
    return Material(
        name=name,
        color=read["color"],
        metallic=read["metallic"],
        roughness=read["roughness"],
        emission=read["emission"],
        transmission=read["transmission"],
        ior=read["ior"],
        tint=read["tint"],
        span=span,
    )


def properties(entries: Sequence[tree.Property], names: Names) -> list[Given]:
    """The properties evaluated; all errors at once."""
    problems = Problems()
    given: list[Given] = []
    for entry in entries:
        try:
            given.append(Given(evaluate(entry.value, names), entry.value.span, entry.name))
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return given


def camera(node: tree.CameraDeclaration, names: Names) -> Camera:
    """`camera { eye target up fov height }`."""
    read = _read("a camera", _CAMERA, properties(node.properties, names), names, node.span)
    if "eye" not in read:
        raise scene_error("a camera needs 'eye'", node.span, "write eye: [x, y, z]")
    said = {entry.name.text: entry for entry in node.properties}
    if "fov" in said and "height" in said:
        message = "a camera has either a field of view or, without perspective, a height"
        raise scene_error(message, said["height"].name.span)
    graph = names.context.graph
    up = read["up"]
    view = read["target"] - read["eye"]
    for value, where in samples(view, names.context):
        if not any(value.numbers):
            raise scene_error(f"the camera's eye is at its target{where}", node.span)
    if "up" not in said and _parallel(view, up, names) is not None:
        up = graph.constant(0.0, 0.0, -1.0)
    where_parallel = _parallel(view, up, names)
    if where_parallel is not None:
        message = f"the camera looks along its up direction{where_parallel}"
        raise scene_error(message, node.span, "give it another one, as in up: [0, 0, -1]")
    return Camera(read["eye"], read["target"], up, read["fov"], read.get("height"))


def _parallel(view: Expr, up: Expr, names: Names) -> str | None:
    """Where the two are parallel, or None where they never are."""
    graph = view.graph
    turned = graph.length(graph.cross(view, up)) / (graph.length(view) * graph.length(up))
    return next((where for value, where in samples(turned, names.context) if not value.number > 1e-9), None)


def light(node: tree.LightDeclaration, names: Names) -> Light:
    """`light { direction … }` is the sun's, `light { position … }` a lamp's."""
    read = _read("a light", _LIGHT, properties(node.properties, names), names, node.span)
    if ("direction" in read) == ("position" in read):
        both = "a light has either a direction or a position, not both"
        message = both if "direction" in read else "a light needs a direction or a position"
        raise scene_error(message, node.span, "direction: the way the light of a sun travels; position: of a lamp")
    if "position" in read:
        return PointLight(read["position"], read["color"], read["intensity"])
    for value, where in samples(read["direction"], names.context):
        if not any(value.numbers):
            raise scene_error(f"a light's direction cannot be zero{where}", node.span)
    return Sun(read["direction"], read["color"], read["intensity"])


def sky(node: tree.SkyDeclaration, names: Names) -> Sky:
    """`sky { zenith horizon ground }`."""
    read = _read("a sky", _SKY, properties(node.properties, names), names, node.span)
    return Sky(read["zenith"], read["horizon"], read["ground"])


def _read(what: str, table: Mapping[str, _Row], given: Sequence[Given], names: Names, span: Span) -> dict[str, Expr]:
    """Every property that was given or has a default, in the table's order."""
    matched = match(what, list(table), given, span, 0, "property")
    graph: FieldGraph = names.context.graph
    problems = Problems()
    read: dict[str, Expr] = {}
    for key, row in table.items():
        try:
            if key in matched:
                read[key] = _property(key, row, matched[key], names)
            elif row.default is not None:
                read[key] = graph.constant(*row.default)
        except SceneError as error:
            problems.take(error)
    problems.finish()
    return read


def _property(key: str, row: _Row, given: Given, names: Names) -> Expr:
    try:
        expr = row.read(given.value, given.span)
    except SceneError as error:
        first = error.diagnostics[0]
        raise SceneError(Diagnostic(f"{key}: {first.message}", first.span, first.hint)) from None
    for value, where in samples(expr, names.context):
        for number in value.numbers:
            within = row.low < number < row.high if row.open else row.low <= number <= row.high
            if not (within and math.isfinite(number)):
                raise scene_error(f"{key} {_wanted(row)}, not {_shown(row, number)}{where}", given.span)
            if abs(number) > LARGEST_NUMBER:
                raise scene_error(f"{key} must be within {LARGEST_NUMBER:g} of zero{where}", given.span)
    return expr


def _shown(row: _Row, number: float) -> str:
    return f"{math.degrees(number):g}deg" if row.degrees else f"{number:g}"


def _wanted(row: _Row) -> str:
    if row.low == -math.inf and row.high == math.inf:
        return "must be finite"
    if row.high == math.inf:
        return f"must be {'greater than' if row.open else 'at least'} {_shown(row, row.low)}"
    return f"must be between {_shown(row, row.low)} and {_shown(row, row.high)}"
