"""Light on what rays hit: the twin of templates/shade/radiance.glsl, by the same functions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import FieldGraph
from sdfc.plan.plan import LIFT, Plan
from sdfc.plan.setting import Setting
from sdfc.reference.formulas import PROPERTIES, Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.surface import Surface, SurfaceFold
from sdfc.reference.trace import StepTracer
from sdfc.scene.model import Light, PointLight, Sun
from sdfc.shade.ambient import OCCLUSION_HEIGHTS
from sdfc.shade.functions import FUNCTIONS
from sdfc.shape.lower import FAR

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Hits:
    """Where n rays hit: points and normals are (3, n), `travelled` (n,) is the path's length up to the points."""

    p: Array
    normal: Array
    view: Array
    travelled: Array
    surface: Surface
    cone: tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Lit:
    """A light seen from points: unit directions to it, how far it is, and its irradiance, if nothing is between."""

    toward: Array
    reach: Array
    irradiance: Array


class Shader:
    """Linear radiance of what rays see, in one setting."""

    def __init__(self, graph: FieldGraph, plan: Plan, setting: Setting, formulas: Formulas) -> None:
        self._plan = plan
        self._setting = setting
        self._formulas = formulas
        self._functions = {name: build(graph) for name, build in FUNCTIONS.items()}
        sky = setting.sky
        colors = {"zenith": sky.zenith, "horizon": sky.horizon, "ground": sky.ground}
        self._sky = {name: _column(formulas.constant(color)) for name, color in colors.items()}
        self._sky["up"] = _column(np.array(setting.up))

    def background(self, d: Array) -> Array:
        """The sky, and the suns in it, (3, n), along unit directions."""
        seen = np.array(self._call("sky_radiance", direction=d, **self._sky))
        for light in self._setting.lights:
            match light:
                case Sun():
                    toward, radiance = self._sun(light)
                    seen += self._call("sun_disc", direction=d, toward=toward) * radiance
                case PointLight():
                    pass
                case _:
                    assert_never(light)
        return seen

    def radiance(self, hits: Hits, tracer: StepTracer, fold: SurfaceFold) -> Array:
        """What is sent to the eye, (3, n)."""
        look = {name: _rows(hits.surface.look, rows) for name, rows in PROPERTIES.items()}
        surface = {name: look[name] for name in ("color", "metallic", "roughness")}
        seen = np.zeros_like(hits.p)
        for light in self._setting.lights:
            seen += self._lit(light, hits, surface, tracer)
        place = {"normal": hits.normal, "view": hits.view}
        occlusion = self._openness(hits, fold)
        seen += self._call("ambient", **place, **surface, occlusion=occlusion, **self._sky)
        if np.any(look["transmission"] > 0.0):
            clear = self._call("transmit", **place, ior=look["ior"], tint=look["tint"], **self._sky)
            seen += (clear - seen) * look["transmission"]
        return seen + look["emission"]

    def _lit(self, light: Light, hits: Hits, surface: dict[str, Array], tracer: StepTracer) -> Array:
        """A light's share, shadows traced from clear of the surface by more than it may be wrong (Keinert 2014)."""
        pixel = Rays(hits.p, hits.view, hits.travelled, hits.cone)
        gradient = np.sqrt(np.sum(hits.surface.field[:3] ** 2, axis=0))
        lift = np.maximum(LIFT, 4.0 * tracer.tolerance(pixel, np.zeros(len(pixel)))) / np.clip(gradient, 0.05, 1.0)
        o = hits.p + lift * hits.normal
        lit = self._light_at(light, o)
        sent = self._call("reflect_light", normal=hits.normal, view=hits.view, light=lit.toward, **surface)
        # what turns away from the light needs no shadow
        facing = np.flatnonzero(np.any(sent * lit.irradiance > 0.0, axis=0))
        rays = Rays(o[:, facing], lit.toward[:, facing], hits.travelled[facing], hits.cone)
        t, _ = tracer.first(rays, np.zeros(len(rays)), lit.reach[facing])
        result = np.zeros_like(hits.p)
        clear = facing[t >= FAR]
        result[:, clear] = (lit.irradiance * sent)[:, clear]
        return result

    def _light_at(self, light: Light, p: Array) -> _Lit:
        match light:
            case Sun():
                toward, irradiance = self._sun(light)
                far = np.full(p.shape[1], FAR)
                return _Lit(np.broadcast_to(toward, p.shape), far, np.broadcast_to(irradiance, p.shape))
            case PointLight():
                position = self._formulas.constant(light.position) - np.array(self._plan.centre)
                offset = _column(position / self._plan.radius) - p
                reach = np.sqrt(np.sum(offset * offset, axis=0))
                power = _column(self._formulas.constant(light.color) * self._formulas.constant(light.intensity))
                left = self._call("point_falloff", offset=offset * self._plan.radius)
                return _Lit(offset / np.maximum(reach, 1e-9), reach, power * left)
            case _:
                assert_never(light)

    def _sun(self, sun: Sun) -> tuple[Array, Array]:
        """The unit direction to it and its irradiance, (3, 1) each."""
        direction = self._formulas.constant(sun.direction)
        toward = -direction / max(math.hypot(*direction), 1e-30)
        return _column(toward), _column(self._formulas.constant(sun.color) * self._formulas.constant(sun.intensity))

    def _openness(self, hits: Hits, fold: SurfaceFold) -> Array:
        if self._plan.is_convex:
            return np.ones(hits.p.shape[1])
        heights = [h * self._setting.reach for h in OCCLUSION_HEIGHTS]
        reach = 1.5 * max(heights)
        distances = np.stack([fold.distance(hits.p + h * hits.normal, reach) for h in heights])
        return self._call("occlusion_weight", distances=distances, heights=_column(np.array(heights)))

    def _call(self, name: str, **arguments: Array) -> Array:
        return self._formulas.call(self._functions[name], arguments)


def _column(numbers: Array) -> Array:
    return np.asarray(numbers, np.float64).reshape(-1, 1)


def _rows(look: Array, rows: slice) -> Array:
    """A property of a stack: (n,) where it has one component, else (k, n)."""
    picked = look[rows]
    return picked[0] if picked.shape[0] == 1 else picked
