"""A traced picture against what is proved of its very rays, in the scene's own coordinates (its unit is its radius)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.diagnostics import Source
from sdfc.field.numeric import Evaluator
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram
from sdfc.pipeline import Compiled, Options
from sdfc.plan.plan import FINE, SMALLEST_TOLERANCE
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.certify import Certificate, first_roots
from sdfc.reference.compare import Comparison, compare
from sdfc.shape.lower import lower

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

THIN = 3e-6  # of the radius: thinner runs of solid are films. The tracer's skins are 2.4e-7 and 9.5e-7
FAR = 1e9  # the tracer's own end of the world

_ORIGINS = """#version 450 core
noperspective in vec3 ray_origin;
layout(location = 0) out vec4 origin_out;
void main() { origin_out = vec4(ray_origin, 0.0); }
"""


@dataclass(frozen=True, slots=True)
class Picture:
    """What the tracer answered for n rays, and the rays themselves: the float32 numbers that it had, as float64.

    `o`, `d`, `normal` are (3, n); `depth` is the t of o + t d, NaN for a miss; `steps` and `material` (n,).
    """

    o: Array
    d: Array
    hit: Mask
    depth: Array
    normal: Array
    steps: Array
    material: Array

    def some(self, index: NDArray[np.intp] | Mask | slice) -> Picture:
        """Some of the rays."""
        return Picture(
            self.o[:, index],
            self.d[:, index],
            self.hit[index],
            self.depth[index],
            self.normal[:, index],
            self.steps[index],
            self.material[index],
        )

    @property
    def points(self) -> Array:
        """The hits, (3, hits), float64."""
        return self.o[:, self.hit] + self.depth[self.hit] * self.d[:, self.hit]


@dataclass(slots=True)
class Tracing:
    """A renderer, with the program that shows where its rays begin."""

    renderer: GlRenderer
    _origins: dict[str, FragmentProgram] = field(default_factory=dict)

    def picture(
        self,
        compiled: Compiled,
        size: tuple[int, int],
        view: View = View(),  # noqa: B008 (frozen)
        params: dict[str, tuple[float, ...]] | None = None,
    ) -> Picture:
        """Every pixel's ray, rows from the top."""
        shot = Shot(compiled, view, params or {}, size)
        first, normal, _, direction = (a.astype(np.float64) for a in self.renderer.probe(shot, None))
        flat = [np.moveaxis(a[..., :3], -1, 0).reshape(3, -1) for a in (normal, direction)]
        hit = first[..., 3].ravel() > 0.5
        depth = np.where(hit, first[..., 0].ravel() / compiled.plan.radius, np.nan)
        return Picture(self._starts(shot), flat[1], hit, depth, flat[0], first[..., 1].ravel(), first[..., 2].ravel())

    def _starts(self, shot: Shot) -> Array:
        vertex = shot.compiled.vertex()
        if vertex not in self._origins:
            self._origins[vertex] = FragmentProgram(self.renderer.device, _ORIGINS, vertex)
        uniforms = shot.compiled.uniforms(shot.view, shot.params, shot.size, (0.0, 0.0))
        with Frame(self.renderer.device, *shot.size, 1) as frame:
            frame.draw(self._origins[vertex], uniforms)
            return np.moveaxis(frame.read(0)[..., :3], -1, 0).reshape(3, -1).astype(np.float64)


def compiled_file(path: Path, tracer: str = "proven") -> Compiled:
    """A scene's file, compiled."""
    kind: pipeline.Kind = "csg" if path.suffix == ".csg" else "sdf"
    scene = pipeline.load(Source(path.name, path.read_text()), path.parent, kind)
    return pipeline.compile_scene(scene, Options(tracer))


def compiled_text(text: str, tracer: str = "proven") -> Compiled:
    """A scene's text, compiled."""
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text), None), Options(tracer))


def every(picture: Picture, most: int) -> Picture:
    """At most `most` of the rays, spread evenly (and not in step with the picture's rows)."""
    count = picture.hit.size
    return picture if count <= most else picture.some(np.linspace(0, count - 1, most).astype(np.intp))


def footprint(compiled: Compiled, size: tuple[int, int], view: View = View()) -> tuple[float, float]:  # noqa: B008
    """Half a pixel: its size at the eye, and its growth with t."""
    half: Any = compiled.uniforms(view, {}, size)["pixel"]
    return float(half[0]), float(half[1])


def tolerance(compiled: Compiled, picture: Picture, cone: tuple[float, float]) -> float:
    """Twice what the tracer takes for touching at the far side of the scene (ALGORITHMS: contested is within 2 eps).

    As a value of the field: one that is no distance, with Lipschitz constant L, may be L eps at a distance of eps.
    """
    reach = float(np.linalg.norm(picture.o, axis=0).max()) + 1.0
    slope = max([1.0, *(leaf.lipschitz for leaf in leaves_of(compiled.plan.root) if isinstance(leaf, Ball))])
    return 2.0 * slope * max(SMALLEST_TOLERANCE, FINE * (cone[0] + cone[1] * reach))


def certified(compiled: Compiled, picture: Picture, near: float, end: float | None = None) -> Certificate:
    """What is proved of the picture's rays; the scene as it is after all passes."""
    reach = np.linalg.norm(picture.o, axis=0) + 1.01
    params = {p.name: p.default for p in compiled.scene.params}
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        last = end if end is not None else (reach if compiled.frame.is_finite else FAR)
        return first_roots(distance, picture.o, picture.d, 0.0, last, params, thin=THIN, tolerance=near)


def verdict(compiled: Compiled, picture: Picture, truth: Certificate, cone: tuple[float, float]) -> Comparison:
    """The picture held against its truth, with the residual of its hits in the scene's own unit."""
    params = {p.name: p.default for p in compiled.scene.params}
    residual = np.zeros(picture.hit.size)
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        (values,) = Evaluator([distance])({"p": picture.points}, params)
    residual[picture.hit] = np.broadcast_to(values, picture.hit.sum())
    scale = np.abs(picture.o).max(axis=0, initial=0.0)
    depth = np.where(picture.hit, picture.depth, np.inf)
    return compare(truth, picture.hit, depth, 2.0 * max(cone), origin_scale=scale, residual=residual)


def wrong(picture: Picture, truth: Certificate) -> NDArray[np.intp]:
    """The indices of uncontested rays that were missed or hit falsely."""
    sure = ~truth.contested & (truth.status != 2)
    return np.flatnonzero(sure & ((truth.status == 1) != picture.hit))
