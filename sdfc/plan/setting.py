"""What is seen besides the solids: camera, lights, sky, live values; and what is pleasant where a scene is silent."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sdfc.field.graph import Expr, FieldGraph, Op, topological
from sdfc.passes.own_origin import Frame
from sdfc.scene.model import Camera, Light, Param, Scene, Sky, Sun
from sdfc.shade.defaults import SKY, key_sun
from sdfc.shape.material import Material

Vector = tuple[float, float, float]
_FOV = math.radians(35.0)
_FROM = (0.62, 0.45, 0.78)  # where a camera stands that the scene does not place: right, above, in front
_ROOM = 1.06  # a framed scene leaves a little air


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """A scene's setting, complete."""

    camera: Camera
    lights: Sequence[Light]
    sky: Sky
    up: Vector
    params: Sequence[Param]
    title: str
    unpainted: Material
    reach: float = 1.0  # of ambient occlusion, in the scene's own unit: 1 where that is the radius of what is there


def setting_of(scene: Scene, frame: Frame) -> Setting:
    """The scene's setting, with defaults for what it does not say."""
    graph = scene.values
    camera = scene.camera or _framed(graph, scene.up, frame)
    defaults = {p.name: p.default for p in scene.params}
    eye, target = values_of(camera.eye, defaults), values_of(camera.target, defaults)
    sun = key_sun(_vector(eye), _vector(target), scene.up)
    lights: Sequence[Light] = scene.lights or (
        Sun(graph.constant(*sun.direction), graph.constant(*sun.color), graph.constant(sun.intensity)),
    )
    sky = scene.sky or Sky(graph.constant(*SKY.zenith), graph.constant(*SKY.horizon), graph.constant(*SKY.ground))
    title = scene.source.name.rsplit("/", 1)[-1]
    return Setting(camera, lights, sky, scene.up, scene.params, title, _unpainted(graph))


def _unpainted(graph: FieldGraph) -> Material:
    """What a part looks like that has no material."""
    grey = 0.48  # linear: a light grey plaster
    one, zero = graph.constant(1.0), graph.constant(0.0)
    black, white = graph.constant(0.0, 0.0, 0.0), graph.constant(1.0, 1.0, 1.0)
    color = graph.constant(grey, grey, grey)
    return Material("unpainted", color, zero, graph.constant(0.5), black, zero, one * 1.5, white)


def _framed(graph: FieldGraph, up: Vector, frame: Frame) -> Camera:
    """A camera that sees all of the scene's finite parts."""
    distance = _ROOM * frame.radius / math.sin(0.5 * _FOV)
    right, above, ahead = _FROM
    # the direction is given for y up; for z up, y points away from the viewer
    toward = (right, above, ahead) if up[1] else (right, -ahead, above)
    size = math.hypot(*toward)
    eye = [c + distance * v / size for c, v in zip(frame.centre, toward, strict=True)]
    return Camera(graph.constant(*eye), graph.constant(*frame.centre), graph.constant(*up), graph.constant(_FOV))


def values_of(value: Expr, params: Mapping[str, tuple[float, ...]]) -> tuple[float, ...]:
    """The components of an expression at given values of the params."""
    if value.is_constant:
        return value.numbers
    made: dict[int, Expr] = {}
    for node in topological([value]):
        if node.op is Op.PARAM:
            made[node.id] = node.graph.constant(*params[str(node.value)])
        else:
            args = tuple(made[a.id] for a in node.args)
            made[node.id] = node.graph.add(node.op, *args, value=node.value) if args else node
    return made[value.id].numbers


def _vector(numbers: tuple[float, ...]) -> Vector:
    return numbers[0], numbers[1], numbers[2]
