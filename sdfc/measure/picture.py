"""What a tracer answered: a picture of rays in the float32 numbers that it had."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram
from sdfc.pipeline import Compiled

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

_ORIGINS = """#version 450 core
noperspective in vec3 ray_origin;
layout(location = 0) out vec4 origin_out;
void main() { origin_out = vec4(ray_origin, 0.0); }
"""


@dataclass(frozen=True, slots=True)
class Picture:
    """What the tracer answered for n rays, and the rays themselves: the float32 numbers that it had, as float64.

    `o`, `d`, `normal` are (3, n); `depth` is the t of o + t d, NaN for a miss; `steps`, `material`, `unfinished` (n,):
    whether a ray was given up at the most steps that it may take, whatever was answered.
    """

    o: Array
    d: Array
    hit: Mask
    depth: Array
    normal: Array
    steps: Array
    material: Array
    unfinished: Mask

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
            self.unfinished[index],
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
        finer: float = 1.0,
    ) -> Picture:
        """Every pixel's ray, rows from the top. `finer`: judged as a pixel that many times smaller."""
        shot = Shot(compiled, view, params or {}, size)
        first, normal, direction = (a.astype(np.float64) for a in self._probed(shot, finer))
        flat = [np.moveaxis(a[..., :3], -1, 0).reshape(3, -1) for a in (normal, direction)]
        depth, steps, material, answer = (np.ascontiguousarray(v) for v in np.moveaxis(first.reshape(-1, 4), -1, 0))
        hit = answer > 0.5
        depth = np.where(hit, depth / compiled.plan.radius, np.nan)
        unfinished = (answer != 0.0) & (answer != 1.0)
        return Picture(self._starts(shot), flat[1], hit, depth, flat[0], steps, material, unfinished)

    def _probed(self, shot: Shot, finer: float) -> list[NDArray[np.floating]]:
        """The first hits, normals and directions."""
        with self.renderer.prepared(shot, "probe", 4) as prepared:
            pixel: Any = prepared.uniforms["pixel"]
            finest = {"pixel": (pixel[0] / finer, pixel[1] / finer, pixel[2])}
            prepared = replace(prepared, uniforms={**prepared.uniforms, **finest})
            prepared.draw()
            return [prepared.read(index) for index in (0, 1, 3)]

    def _starts(self, shot: Shot) -> Array:
        vertex = shot.compiled.vertex()
        if vertex not in self._origins:
            self._origins[vertex] = FragmentProgram(self.renderer.device, _ORIGINS, vertex)
        uniforms = shot.compiled.uniforms(shot.view, shot.params, shot.size, (0.0, 0.0))
        with Frame(self.renderer.device, *shot.size, 1) as frame:
            frame.draw(self._origins[vertex], uniforms)
            return np.moveaxis(frame.read(0)[..., :3], -1, 0).reshape(3, -1).astype(np.float64)


def every(picture: Picture, most: int) -> Picture:
    """At most `most` of the rays, spread evenly (and not in step with the picture's rows)."""
    count = picture.hit.size
    return picture if count <= most else picture.some(np.linspace(0, count - 1, most).astype(np.intp))
