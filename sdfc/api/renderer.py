"""The two ways to draw a compiled scene, OpenGL and the CPU, behind one face."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

from sdfc.api.request import View
from sdfc.diagnostics import DeviceError
from sdfc.plan.plan import NEAR_EYE, TILE

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdfc.gpu.frame import Frame
    from sdfc.gpu.program import FragmentProgram, Value
    from sdfc.pipeline import Compiled
    from sdfc.plan.prove import Rays

Progress: TypeAlias = Callable[[float], None]
Buffer: TypeAlias = "NDArray[np.floating]"


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """What is to be drawn: a compiled scene, seen so, with these live values, this large."""

    compiled: Compiled
    view: View
    params: Mapping[str, tuple[float, ...]]
    size: tuple[int, int]


class Renderer(Protocol):
    """Draws shots. Buffers are float (height, width, 4), rows from the top."""

    @property
    def name(self) -> str:
        """What draws, as it calls itself."""

    @property
    def rays(self) -> Rays:
        """Which ray intervals in closed form to compile for it: whether those that are dear cost less than marching."""

    def radiance(self, shot: Shot, sample: int, progress: Progress | None) -> Buffer:
        """Linear radiance and, in the last channel, whether something was hit (0 or 1), for one sample of a pixel."""

    def probe(self, shot: Shot, progress: Progress | None) -> list[Buffer]:
        """At the pixels' centres: (depth, steps, material, hit), (normal, 0), (position, 0), (ray direction, 0)."""

    def depth(self, shot: Shot, progress: Progress | None) -> Buffer:
        """The first image of `probe` alone, without material: nothing is computed that a depth image does not need."""

    def kept_frames(self) -> AbstractContextManager[None]:
        """Meanwhile, what pictures are drawn into is kept from one to the next."""

    def close(self) -> None:
        """Give back what it holds."""


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """The cone prepass of a shot: how far from the eye every tile of pixels is proven empty, as texture 0."""

    tiles: Frame
    program: FragmentProgram

    def draw(self, uniforms: Mapping[str, Value]) -> None:
        """Sweep, and let what is drawn next read it."""
        self.tiles.draw_whole(self.program, uniforms)
        self.tiles.bind()


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """What `GlRenderer.prepared` gives: `draw` draws all stages over the whole frame, and waits until it is done."""

    frame: Frame
    program: FragmentProgram
    uniforms: dict[str, Value]  # may be changed between draws
    sweep: Sweep | None

    def draw(self) -> None:
        """One frame. The first draw of a program compiles it (llvmpipe)."""
        if self.sweep is not None:
            self.sweep.draw(self.uniforms)
        self.frame.draw_whole(self.program, self.uniforms)

    def read(self, attachment: int = 0) -> Buffer:
        """An image of the last frame, (height, width, 4), rows from the top."""
        return self.frame.read(attachment)


class GlRenderer:
    """Draws with OpenGL, on a device of its own; keeps the programs that it has compiled."""

    def __init__(self) -> None:
        from sdfc.gpu.device import open_device
        from sdfc.gpu.frames import Frames

        self.device = open_device()
        self._frames = Frames(self.device)
        self._programs: dict[str, FragmentProgram] = {}

    @property
    def name(self) -> str:
        """What draws, as the driver calls it."""
        return self.device.renderer

    @property
    def rays(self) -> Rays:
        """Long formulas are cheap where there is hardware for them; llvmpipe computes them for every pixel."""
        return "cheap" if self.device.is_llvmpipe else "all"

    def radiance(self, shot: Shot, sample: int, progress: Progress | None) -> Buffer:
        """See Renderer."""
        return self._draw(shot, "radiance", 1, sample, progress)[0]

    def probe(self, shot: Shot, progress: Progress | None) -> list[Buffer]:
        """See Renderer."""
        return self._draw(shot, "probe", 4, 0, progress)

    def depth(self, shot: Shot, progress: Progress | None) -> Buffer:
        """See Renderer."""
        return self._draw(shot, "depth", 1, 0, progress)[0]

    @contextmanager
    def prepared(self, shot: Shot, entry: str, attachments: int = 1) -> Iterator[Prepared]:
        """A shot whose programs are compiled and whose frame is there, to be drawn as often as a measurement asks."""
        uniforms = shot.compiled.uniforms(shot.view, shot.params, shot.size)
        program = self._program(shot.compiled.glsl(entry, "fragment", is_near(uniforms)), shot.compiled.vertex())
        with self._sweep(shot) as sweep, self._frames.lent(*shot.size, attachments) as frame:
            yield Prepared(frame, program, uniforms, sweep)

    @contextmanager
    def _sweep(self, shot: Shot) -> Iterator[Sweep | None]:
        """The shot's cone prepass, if its plan has one."""
        from sdfc.gpu.program import FragmentProgram

        if not shot.compiled.plan.prepass:
            yield None
            return
        glsl = shot.compiled.glsl("cone", "fragment")
        if glsl not in self._programs:
            self._programs[glsl] = FragmentProgram(self.device, glsl)
        with self._frames.lent(*(-(-side // TILE) for side in shot.size)) as tiles:
            yield Sweep(tiles, self._programs[glsl])

    def _draw(self, shot: Shot, entry: str, attachments: int, sample: int, progress: Progress | None) -> list[Buffer]:
        uniforms = shot.compiled.uniforms(shot.view, shot.params, shot.size, jitter(sample))
        program = self._program(shot.compiled.glsl(entry, "fragment", is_near(uniforms)), shot.compiled.vertex())
        with self._sweep(shot) as sweep, self._frames.lent(*shot.size, attachments) as frame:
            if sweep is not None:
                sweep.draw(uniforms)
            frame.draw(program, uniforms, progress)
            images: list[Buffer] = [frame.read(index) for index in range(attachments)]
        if (images[0][..., 3] < 0.0).any():  # gpu.frame.UNDRAWN
            raise DeviceError(f"{self.name} reported success, but left pixels undrawn")
        return images

    def _program(self, glsl: str, vertex: str) -> FragmentProgram:
        from sdfc.gpu.program import FragmentProgram

        if glsl not in self._programs:
            self._programs[glsl] = FragmentProgram(self.device, glsl, vertex)
        return self._programs[glsl]

    def keep(self, fragments: Collection[str]) -> None:
        """Release every program but those of these fragment shaders."""
        for glsl in self._programs.keys() - set(fragments):
            self._programs.pop(glsl).release()

    def kept_frames(self) -> AbstractContextManager[None]:
        """See Renderer."""
        return self._frames.kept()

    def close(self) -> None:
        """Give the device back, and its programs with it."""
        self._programs.clear()
        self._frames.release()
        self.device.close()


def is_near(uniforms: Mapping[str, Value]) -> bool:
    """Whether the eye is so near that rays are moved to the scene by one step. A parallel ray begins there anyway."""
    eye = uniforms["eye"]
    return isinstance(eye, tuple) and math.hypot(*eye) <= NEAR_EYE


def jitter(sample: int) -> tuple[float, float]:
    """Where in its pixel a sample lies, from the centre, in pixels: Roberts's R2 sequence (2018), the centre first."""
    return (0.5 + sample * 0.7548776662466927) % 1.0 - 0.5, (0.5 + sample * 0.5698402909980532) % 1.0 - 0.5
