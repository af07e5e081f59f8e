"""The scene's lights and sky as GLSL."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph
from sdfc.glsl.body import Body
from sdfc.glsl.live import Live
from sdfc.scene.model import Light, PointLight, Sky, Sun


@dataclass(frozen=True, slots=True)
class LightText:
    """Statements that set `toward`, `reach` and `irradiance` for a point `p`."""

    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SunText:
    """What the sky shows of a sun."""

    toward: str
    radiance: str


class LightWriter:
    """Writes lights in the scene's own coordinates."""

    def __init__(self, graph: FieldGraph, live: Live, centre: tuple[float, float, float], radius: float) -> None:
        self._graph = graph
        self._live = live
        self._centre = centre
        self._radius = radius

    def lights(self, lights: Sequence[Light]) -> list[LightText]:
        return [self._light(light) for light in lights]

    def suns(self, lights: Sequence[Light]) -> list[SunText]:
        return [self._sun(light) for light in lights if isinstance(light, Sun)]

    def sky(self, sky: Sky) -> str:
        return ", ".join(Body(self._live).texts([sky.zenith, sky.horizon, sky.ground]))

    def _unit(self, v: Expr) -> Expr:
        return v / self._graph.max(self._graph.length(v), 1e-30)

    def _sun(self, sun: Sun) -> SunText:
        toward, radiance = Body(self._live).texts([-self._unit(sun.direction), sun.color * sun.intensity])
        return SunText(toward, f"({radiance})")

    def _light(self, light: Light) -> LightText:
        body = Body(self._live, 0)
        match light:
            case Sun():
                toward, irradiance = body.texts([-self._unit(light.direction), light.color * light.intensity])
                body.add(f"toward = {toward};")
                body.add("reach = FAR;")
                body.add(f"irradiance = {irradiance};")
            case PointLight():
                own = (light.position - self._graph.constant(*self._centre)) / self._radius
                position, power = body.texts([own, light.color * light.intensity])
                body.add(f"vec3 offset = {position} - p;")
                body.add("reach = length(offset);")
                body.add("toward = offset / max(reach, 1e-9);")
                body.add(f"irradiance = {power} * point_falloff(RADIUS * offset);")
            case _:
                assert_never(light)
        return LightText(tuple(body.lines))
