"""A compiled scene: what it renders to, its GLSL, and what the compiler found out about it."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self
from warnings import warn

from sdfc.api.request import (
    AUTO,
    Setting,
    View,
    checked_names,
    checked_params,
    checked_samples,
    checked_size,
    checked_tracer,
)
from sdfc.api.source import Input, Kind, from_path, from_text, looks_like_path
from sdfc.diagnostics import DeviceError, Diagnostic
from sdfc.image.picture import AOVS

if TYPE_CHECKING:
    from sdfc.api.animation import Change
    from sdfc.api.job import Job
    from sdfc.api.renderer import GlRenderer, Progress, Renderer
    from sdfc.image.picture import Image
    from sdfc.pipeline import Compiled, Options
    from sdfc.plan.prove import Rays
    from sdfc.scene.model import Param, Scene

BACKENDS = ("auto", "gl", "cpu")
DEFAULT_SIZE = (1280, 720)
DEFAULT_TRACER = AUTO


class Program:
    """A scene, compiled. Keeps its OpenGL device and programs between renders; `close` (or `with`) gives them back."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._compiled: dict[Options, Compiled] = {}
        self._renderers: dict[str, Renderer] = {}
        self._close = weakref.finalize(self, _close_all, self._renderers)

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """What is odd about the scene, but not wrong."""
        return self.scene.warnings

    @property
    def params(self) -> tuple[Param, ...]:
        """The live values: what `render(params=...)` may set."""
        return self.scene.params

    def compiled(self, tracer: str = DEFAULT_TRACER, rays: Rays = "cheap") -> Compiled:
        """The compiler's result for a tracer, made once. `rays`: whether closed forms that are dear are used too."""
        from sdfc.pipeline import Options

        checked = checked_tracer(tracer)
        return self.compiled_as(Options(rays=rays) if checked == AUTO else Options(tracer=checked, rays=rays))

    def compiled_as(self, options: Options) -> Compiled:
        """The compiler's result for exactly these options, made once."""
        if options not in self._compiled:
            from sdfc import pipeline

            self._compiled[options] = pipeline.compile_scene(self.scene, options)
        return self._compiled[options]

    def glsl(
        self,
        target: str = "glsl450",
        stage: str | None = None,
        tracer: str = DEFAULT_TRACER,
        *,
        part: str = "full",
        prefix: str | None = None,
        bake: bool = False,
        params: Mapping[str, Setting] | None = None,
    ) -> str:
        """The scene's picture as one complete shader, or its `field` or `tracer` for a shader of your own.

        `stage` is the target's first by default. `prefix` begins every global name (of a part: its file's name by
        default). `bake` makes params constants: their defaults, or `params`. docs/emit-glsl.md has all targets.
        """
        from sdfc.api.emission import emitted

        return emitted(self, target, stage, tracer, part, prefix, bake, params or {})

    def explanation(self, tracer: str = DEFAULT_TRACER) -> str:
        """What the compiler proved of the scene, how it will be traced, with reasons, and what it does not get.

        Where the planner chooses, it measures the device (once) and, where predictions are close, tries candidates.
        """
        from sdfc.api import account
        from sdfc.api.choose import decide, options_of
        from sdfc.pipeline import Options

        if checked_tracer(tracer) != AUTO:
            compiled, options, reasons = self.compiled(tracer), Options(tracer=tracer), []
        else:
            decision = decide(self.scene, self._device_if_any(), pilot=True)
            options = options_of(decision.chosen)
            compiled, reasons = self.compiled_as(options), account.chosen(decision)
        return "\n".join(
            [compiled.explanation(), *account.faint(compiled), *reasons, *account.left_out(compiled, options)]
        )

    def _device_if_any(self) -> GlRenderer | None:
        from sdfc.api.renderer import GlRenderer

        try:
            renderer = self._renderer("gl", lambda _: None)
        except DeviceError:
            return None
        return renderer if isinstance(renderer, GlRenderer) else None

    def render(
        self,
        size: tuple[int, int] = DEFAULT_SIZE,
        *,
        camera: View | None = None,
        params: Mapping[str, Setting] | None = None,
        samples: int = 1,
        tracer: str = DEFAULT_TRACER,
        backend: str = "auto",
        aovs: Iterable[str] = AOVS,
        progress: Progress | None = None,
        note: Callable[[str], None] = warn,
    ) -> Image:
        """A picture of `size` (width, height) pixels, by `samples` rays a pixel.

        `params` are in the scene's units (angles in radians, colours linear); `progress` is told the share done and may
        raise to stop; `note` is told what happened that was not asked for (no OpenGL: slower).
        """
        values, view = checked_params(self.params, params or {}), camera or View()
        job = self._job(size, samples, tracer, backend, aovs, note)
        job.tell(view, values, note)
        return job.image(view, values, progress)

    def frames(
        self,
        frames: range,
        size: tuple[int, int] = DEFAULT_SIZE,
        *,
        fps: float = 30.0,
        loop: bool = False,
        skip: Container[int] = (),
        camera: View | None = None,
        params: Mapping[str, Change] | None = None,
        samples: int = 1,
        tracer: str = DEFAULT_TRACER,
        backend: str = "auto",
        aovs: Iterable[str] = (),
        progress: Progress | None = None,
        note: Callable[[str], None] = warn,
    ) -> Iterator[Image]:
        """The pictures of an animation, compiled once and drawn as they are asked for, but for the frames in `skip`.

        A param may be a Sweep over the frames (`loop`: to be repeated without a halt), or a text like `0deg..360deg`;
        one named `time` is frame / fps, unless it is given. Values are checked at once, before anything is drawn.
        """
        from sdfc.api.animation import Timeline, motion_of, pictures

        motion, view = motion_of(self.params, params or {}, Timeline(frames, fps, loop)), camera or View()
        wanted = [frame for frame in frames if frame not in skip]
        if not wanted:
            return iter(())
        if motion.is_still and len(frames) > 1:
            note("all frames are the same: sweep a param (0..1), or give the scene one named 'time'")
        job = self._job(size, samples, tracer, backend, aovs, note, len(wanted))
        job.tell(view, motion.values(wanted[0]), note)
        return pictures(job, view, wanted, motion.values, progress)

    def _job(
        self,
        size: tuple[int, int],
        samples: int,
        tracer: str,
        backend: str,
        aovs: Iterable[str],
        note: Callable[[str], None],
        count: int = 1,
    ) -> Job:
        """What is asked for, checked, on its device, and compiled as `count` such pictures are worth it."""
        from sdfc.api.job import Job

        size, samples = checked_size(size), checked_samples(samples)
        wanted = checked_names("image", aovs, AOVS)
        (backend,) = checked_names("backend", (backend,), BACKENDS)
        renderer = self._renderer(backend, note)
        compiled = self._chosen(checked_tracer(tracer), renderer, size[0] * size[1] * samples * count)
        return Job(renderer, compiled, size, samples, wanted)

    def _chosen(self, tracer: str, renderer: Renderer, rays: int) -> Compiled:
        """The scene as it will be traced: as asked, or for much work as the planner finds it to be fastest."""
        from sdfc.api.choose import WORTH_A_PILOT, decide, options_of
        from sdfc.api.renderer import GlRenderer

        if tracer == AUTO and isinstance(renderer, GlRenderer) and rays >= WORTH_A_PILOT:
            return self.compiled_as(options_of(decide(self.scene, renderer, pilot=True).chosen))
        return self.compiled(tracer, renderer.rays)

    def _renderer(self, backend: str, note: Callable[[str], None]) -> Renderer:
        if backend not in self._renderers:
            self._renderers[backend] = open_renderer(backend, note)
        return self._renderers[backend]

    def close(self) -> None:
        """Give back the device, if one was opened. The program can still be used; it opens another."""
        _close_all(self._renderers)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


def load(given: Input) -> Program:
    """Read and elaborate a scene. Raises SceneError with everything that is wrong with it."""
    from sdfc import pipeline

    return Program(pipeline.load(given.source, given.folder, given.kind))


def compile(scene: str | Path, kind: Kind | None = None) -> Program:
    """A program from a scene's text or its file (a Path, or a name that ends in `.sdf` or `.csg`)."""
    if isinstance(scene, Path) or looks_like_path(scene):
        return load(from_path(scene, kind))
    return load(from_text(scene, kind or "sdf"))


def open_renderer(backend: str, note: Callable[[str], None]) -> Renderer:
    """What draws: OpenGL where there is one, or NumPy, which `note` is told."""
    if backend != "cpu":
        from sdfc.api.renderer import GlRenderer

        try:
            return GlRenderer()
        except DeviceError as error:
            if backend == "gl":
                raise
            reason = str(error).splitlines()[0]
            note(f"{reason}: rendering with NumPy, which is much slower (`sdfc doctor` says what to install)")
    from sdfc.api.cpu import CpuRenderer

    return CpuRenderer()


def _close_all(renderers: dict[str, Renderer]) -> None:
    while renderers:
        renderers.popitem()[1].close()
