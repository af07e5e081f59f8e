"""Pictures in float64 with NumPy: what is drawn where there is no OpenGL, and a second opinion where there is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import FieldGraph
from sdfc.plan.plan import Plan
from sdfc.plan.setting import Setting
from sdfc.plan.steps import leaves_of
from sdfc.plan.view import CameraChange
from sdfc.reference.formulas import Formulas
from sdfc.reference.light import Hits, Shader
from sdfc.reference.rays import Rays
from sdfc.reference.surface import Surface, SurfaceFold
from sdfc.reference.trace import StepTracer, finest, members_of
from sdfc.scene.model import Scene
from sdfc.shape.lower import FAR

Array = NDArray[np.float64]
Params = Mapping[str, tuple[float, ...]]
Uniforms = Mapping[str, float | tuple[float, ...]]
Progress = Callable[[float], None]

MOST_RAYS = 65536
"""How many rays are traced at once: fewer calls of NumPy, more memory."""
INTERVALS_AT_ONCE = 1 << 22
"""How many intervals a bundle of rays may hold."""


class Compiled(Protocol):
    """What is read of a compiled scene (sdfc.pipeline makes it)."""

    def __hash__(self) -> int: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def plan(self) -> Plan: ...
    @property
    def setting(self) -> Setting: ...
    def uniforms(
        self, view: CameraChange, params: Params, size: tuple[int, int], jitter: tuple[float, float] = ...
    ) -> dict[str, float | tuple[float, ...]]: ...


@dataclass(frozen=True, slots=True)
class _Seen:
    """What a bundle of rays found: depth along the ray (FAR for none), steps, and what is at the hits."""

    rays: Rays
    depth: Array
    steps: Array
    hit: NDArray[np.int64]
    hits: Hits


class _Studio:
    """One compiled scene at given values of its params."""

    def __init__(self, compiled: Compiled, params: Params) -> None:
        graph: FieldGraph = compiled.scene.values
        values = {p.name: p.default for p in compiled.scene.params} | dict(params)
        self.plan = compiled.plan
        formulas = Formulas(graph, values, compiled.plan.materials, compiled.setting.unpainted)
        self.tracer = StepTracer(compiled.plan, formulas)
        self.fold = SurfaceFold(compiled.plan, formulas)
        self.shader = Shader(graph, compiled.plan, compiled.setting, formulas)

    def look(self, rays: Rays) -> _Seen:
        """First hits, put on the surface itself by one Newton step (twin of templates/shade/polish.glsl)."""
        t, steps = self.tracer.first(rays, -rays.travelled, np.full(len(rays), FAR))
        hit = np.flatnonzero(t < FAR)
        seen = rays.take(hit)
        at = t[hit]
        surface = self.fold.at(seen.at(at), seen.d, finest(at))
        at = at - self._correction(seen, at, surface)
        normal = _unit(surface.field[:3])
        along = np.sum(normal * -seen.d, axis=0)
        turned = _unit(normal + 1.001 * along * seen.d)
        normal = np.where(along > 0.0, normal, turned)
        depth = np.full(len(rays), FAR)
        depth[hit] = seen.travelled + at
        hits = Hits(seen.at(at), normal, -seen.d, depth[hit], surface, rays.cone)
        return _Seen(rays, depth, steps, hit, hits)

    def _correction(self, rays: Rays, t: Array, surface: Surface) -> Array:
        slope = np.sum(surface.field[:3] * rays.d, axis=0)
        facing = slope < -0.05 * _length(surface.field[:3])
        most = 4.0 * self.tracer.tolerance(rays, t)
        step = surface.field[3] / np.where(facing, slope, -1.0)
        return np.where(facing, np.clip(step, -most, most), 0.0)


@lru_cache(maxsize=1)
def _studio(compiled: Compiled, params: tuple[tuple[str, tuple[float, ...]], ...]) -> _Studio:
    """The last one is kept: a picture is made of many samples, and its formulas are prepared once."""
    return _Studio(compiled, dict(params))


def radiance(
    compiled: Compiled,
    view: CameraChange,
    params: Params,
    size: tuple[int, int],
    jitter: tuple[float, float] = (0.0, 0.0),
    progress: Progress | None = None,
) -> Array:
    """Linear radiance and whether something was hit, (height, width, 4), rows from the top; `jitter` in pixels."""
    studio = _studio(compiled, tuple(sorted(params.items())))
    picture = np.zeros((size[0] * size[1], 4))
    for chunk, rays in _bundles(studio.plan, compiled.uniforms(view, params, size, jitter), size, progress):
        seen = studio.look(rays)
        part = picture[chunk]
        missed = np.flatnonzero(seen.depth >= FAR)
        part[missed, :3] = studio.shader.background(rays.d[:, missed]).T
        part[seen.hit, :3] = studio.shader.radiance(seen.hits, studio.tracer, studio.fold).T
        part[seen.hit, 3] = 1.0
    return picture.reshape(size[1], size[0], 4)


def probe(
    compiled: Compiled,
    view: CameraChange,
    params: Params,
    size: tuple[int, int],
    progress: Progress | None = None,
) -> list[NDArray[np.floating]]:
    """At the pixels' centres, (height, width, 4) each, rows from the top, in the scene's units.

    (depth, steps, material, hit), (normal, 0), (position, 0), (ray direction, 0); depth and material are -1 for a miss.
    """
    studio = _studio(compiled, tuple(sorted(params.items())))
    images = [np.zeros((size[0] * size[1], 4)) for _ in range(4)]
    plan = studio.plan
    for chunk, rays in _bundles(plan, compiled.uniforms(view, params, size), size, progress):
        seen = studio.look(rays)
        first, normal, position, direction = (image[chunk] for image in images)
        first[:, 0], first[:, 1], first[:, 2] = -1.0, seen.steps, -1.0
        first[seen.hit, 0] = seen.hits.travelled * plan.radius
        first[seen.hit, 2] = seen.hits.surface.material
        first[seen.hit, 3] = 1.0
        normal[seen.hit, :3] = _unit(seen.hits.surface.field[:3]).T
        position[seen.hit, :3] = seen.hits.p.T * plan.radius + np.array(plan.centre)
        direction[:, :3] = rays.d.T
    buffers: list[NDArray[np.floating]] = [image.reshape(size[1], size[0], 4) for image in images]
    return buffers


def _bundles(
    plan: Plan, uniforms: Uniforms, size: tuple[int, int], progress: Progress | None
) -> Iterator[tuple[slice, Rays]]:
    """Rays of the picture, a bundle at a time, with their places in it."""
    pixels = size[0] * size[1]
    largest = max((len(leaves_of(member)) for member in members_of(plan.root)), default=1)  # solved one at a time
    count = max(1024, min(MOST_RAYS, INTERVALS_AT_ONCE // max(1, largest)))
    for begin in range(0, pixels, count):
        end = min(begin + count, pixels)
        yield slice(begin, end), _camera_rays(uniforms, np.arange(begin, end), size)
        if progress is not None:
            progress(end / pixels)


def _camera_rays(uniforms: Uniforms, pixels: NDArray[np.int64], size: tuple[int, int]) -> Rays:
    """The rays of pixels numbered by rows from the top, each from where it is nearest the scene's origin."""
    eye, axis_x, axis_y, axis_z = (np.reshape(uniforms[n], (3, 1)) for n in ("eye", "axis_x", "axis_y", "axis_z"))
    width, height = size
    _, _, jitter_x, jitter_y = np.ravel(uniforms["window"])
    at_eye, growth, perspective = np.ravel(uniforms["pixel"])
    x = (pixels % width + 0.5 + jitter_x) / width * 2.0 - 1.0
    y = (height - 1 - pixels // width + 0.5 + jitter_y) / height * 2.0 - 1.0
    across = x * axis_x + y * axis_y
    o = eye + (1.0 - perspective) * across
    d = _unit(axis_z + perspective * across)
    travelled = -np.sum(o * d, axis=0)
    return Rays(o + travelled * d, d, travelled, (float(at_eye), float(growth)))


def _unit(v: Array) -> Array:
    unit: Array = v / np.maximum(_length(v), 1e-30)
    return unit


def _length(v: Array) -> Array:
    length: Array = np.sqrt(np.sum(v * v, axis=0))
    return length
