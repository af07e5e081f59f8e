"""A compiled scene: what it renders to, its GLSL, and what the compiler found out about it."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self
from warnings import warn

from sdfc.api.renderer import GlRenderer, Progress, Renderer, Shot
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
from sdfc.image.picture import AOVS, Image

if TYPE_CHECKING:
    from sdfc.image.picture import Array
    from sdfc.pipeline import Compiled, Options
    from sdfc.plan.prove import Rays
    from sdfc.scene.model import Param, Scene

BACKENDS = ("auto", "gl", "cpu")
DEFAULT_SIZE = (1280, 720)
DEFAULT_TRACER = AUTO
FLOAT32 = 2.0**-22  # of the scene's radius: what hits are right to (plan.GROW)
FEWEST_DIGITS = 4.0 * FLOAT32  # the narrowest pixel that float32 is good for


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
        return "\n".join([compiled.explanation(), *reasons, *account.left_out(compiled, options)])

    def _device_if_any(self) -> GlRenderer | None:
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
        size, samples = checked_size(size), checked_samples(samples)
        wanted = checked_names("image", aovs, AOVS)
        values = checked_params(self.params, params or {})
        (backend,) = checked_names("backend", (backend,), BACKENDS)
        renderer = self._renderer(backend, note)
        compiled = self._chosen(checked_tracer(tracer), renderer, size[0] * size[1] * samples)
        shot = Shot(compiled, camera or View(), values, size)
        if isinstance(renderer, GlRenderer):
            _note_digits(shot, note)
        elif not compiled.plan.tracer.needs_steps:
            note(f"NumPy traces by the step rules of 'proven' alone: '{compiled.plan.tracer.name}' is for OpenGL")
        passes = samples + bool(wanted)
        colour = _accumulated(renderer, shot, [_part(progress, sample, passes) for sample in range(samples)])
        kept = _aovs(renderer, shot, wanted, _part(progress, samples, passes)) if wanted else {}
        return Image(colour, kept, tuple(shot.compiled.materials), renderer.name)

    def _chosen(self, tracer: str, renderer: Renderer, rays: int) -> Compiled:
        """The scene as it will be traced: as asked, or for much work as the planner finds it to be fastest."""
        from sdfc.api.choose import WORTH_A_PILOT, decide, options_of

        if tracer == AUTO and isinstance(renderer, GlRenderer) and rays >= WORTH_A_PILOT:
            return self.compiled_as(options_of(decide(self.scene, renderer, pilot=True).chosen))
        return self.compiled(tracer, renderer.rays)

    def _renderer(self, backend: str, note: Callable[[str], None]) -> Renderer:
        if backend not in self._renderers:
            self._renderers[backend] = _opened(backend, note)
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


def _opened(backend: str, note: Callable[[str], None]) -> Renderer:
    if backend != "cpu":
        try:
            return GlRenderer()
        except DeviceError as error:
            if backend == "gl":
                raise
            reason = str(error).splitlines()[0]
            note(f"{reason}: rendering with NumPy, which is much slower (`sdfc doctor` says what to install)")
    from sdfc.api.cpu import CpuRenderer

    return CpuRenderer()


def _note_digits(shot: Shot, note: Callable[[str], None]) -> None:
    """Say so where float32 has not enough digits for what is looked at: small things in a scene that is very large."""
    pixel, radius = shot.compiled.pixel(shot.view, shot.params, shot.size), shot.compiled.frame.radius
    if pixel < FEWEST_DIGITS:
        note(
            f"a pixel is {pixel * radius:.2g} wide where the camera looks, but in a scene of radius {radius:.3g} "
            f"float32 is right to {FLOAT32 * radius:.2g}: expect faults (--backend cpu has float64)"
        )


def _close_all(renderers: dict[str, Renderer]) -> None:
    while renderers:
        renderers.popitem()[1].close()


def _accumulated(renderer: Renderer, shot: Shot, parts: Sequence[Progress | None]) -> Array:
    """The mean radiance of one sample for each part of the progress, float32 (height, width, 3)."""
    import numpy as np

    total = np.zeros((shot.size[1], shot.size[0], 3))
    for sample, part in enumerate(parts):
        total += renderer.radiance(shot, sample, part)[..., :3]
    if not np.isfinite(total).any():
        raise DeviceError(f"{renderer.name} drew nothing but NaN")
    return (total / len(parts)).astype(np.float32)


def _aovs(renderer: Renderer, shot: Shot, wanted: tuple[str, ...], progress: Progress | None) -> dict[str, Array]:
    """The images beside the colour that are wanted, in the forms that Image documents."""
    import numpy as np

    if set(wanted) <= {"depth", "steps"}:
        first = normal = position = renderer.depth(shot, progress)
    else:
        first, normal, position, _ = renderer.probe(shot, progress)
    hit = first[..., 3] > 0.5
    made: dict[str, Callable[[], Array]] = {
        "depth": lambda: np.where(hit, first[..., 0], np.inf).astype(np.float32),
        "normal": lambda: np.where(hit[..., None], normal[..., :3], 0.0).astype(np.float32),
        "position": lambda: np.where(hit[..., None], position[..., :3], np.nan).astype(np.float32),
        "material": lambda: np.where(hit, np.round(first[..., 2]), -1).astype(np.int32),
        "steps": lambda: np.round(first[..., 1]).astype(np.int32),
    }
    return {name: made[name]() for name in wanted}


def _part(progress: Progress | None, index: int, count: int) -> Progress | None:
    """Progress of one of `count` equal parts, as progress of the whole."""
    if progress is None:
        return None
    whole = progress

    def report(share: float) -> None:
        whole((index + share) / count)

    return report
