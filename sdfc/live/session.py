"""One scene's picture through many edits: what each needs, done; what is old, released."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path

from sdfc.api.files import write_files
from sdfc.api.program import open_renderer
from sdfc.api.renderer import GlRenderer, Renderer, Shot
from sdfc.api.request import AUTO, View, checked_size, checked_tracer
from sdfc.diagnostics import DeviceError, Diagnostic
from sdfc.image.picture import Image
from sdfc.live import numbers
from sdfc.live.build import ENTRY, Built, Touched, aimed, build, load
from sdfc.live.snapshot import Edit, Snapshot, compare
from sdfc.pipeline import Compiled, Options

_PROGRAMS_KEPT = 4  # the last ones: an edit that is undone needs no compiling


class Speed(Enum):
    """What an edit cost: from nothing to a shader that the driver has not seen."""

    NOTHING = "nothing to draw"
    NUMBERS = "numbers"
    CAMERA = "camera"
    SAME_SHADER = "same shader"
    NEW_SHADER = "new shader"


@dataclass(frozen=True, slots=True)
class Update:
    """What was done for a save. Times in milliseconds, by what took them."""

    speed: Speed
    times: dict[str, float]
    live: int  # literals that are uniforms now
    warnings: tuple[Diagnostic, ...] = ()

    @property
    def milliseconds(self) -> float:
        return sum(self.times.values())


@dataclass(slots=True)
class _Watch:
    """Time since the last look."""

    times: dict[str, float] = field(default_factory=dict)
    since: float = field(default_factory=time.perf_counter)

    def took(self, what: str) -> None:
        now = time.perf_counter()
        self.times[what] = 1e3 * (now - self.since)
        self.since = now


class Session:
    """Draws the snapshots of one scene, one after the other, into one file."""

    def __init__(
        self, output: Path, size: tuple[int, int], tracer: str, backend: str, note: Callable[[str], None]
    ) -> None:
        self.output = output
        self.size = checked_size(size)
        self.tracer = checked_tracer(tracer)
        self._backend = backend
        self._note = note
        self._renderer: Renderer | None = None
        self._shown: Built | None = None
        self._values: dict[str, tuple[float, ...]] = {}
        self._recent: dict[str, Compiled] = {}  # whose shaders are on the device, by their code, the last one last

    @property
    def renderer(self) -> Renderer:
        """What draws; opened at the first picture, and again after it failed."""
        if self._renderer is None:
            self._renderer = open_renderer(self._backend, self._note)
        return self._renderer

    def update(self, snapshot: Snapshot) -> Update:
        """Draw the snapshot. Raises what is wrong with it, the device or the file, and goes on showing the last."""
        watch = _Watch()
        shown = self._shown
        edit = Edit(structure=True) if shown is None else compare(shown.snapshot, snapshot)
        if shown is None or not _is_quick(shown, snapshot, edit):
            return self._rebuild(snapshot, edit, watch)
        built = replace(shown, snapshot=snapshot, live=_touched_last(shown, edit))
        if edit == Edit():
            self._shown = built
            return Update(Speed.NOTHING, {}, len(built.live))
        values = self._values | {
            made.name: snapshot.literal(key).value for key in edit.literals if (made := shown.bound(key)) is not None
        }
        if edit.camera or (shown.compiled.scene.camera is None and built.live):
            scene = load(snapshot, {})
            built = replace(built, compiled=aimed(built.compiled, scene, self._options()))
        watch.took("reading")
        self._show(built, values, watch)
        return Update(Speed.CAMERA if edit.camera else Speed.NUMBERS, watch.times, len(built.live))

    def _rebuild(self, snapshot: Snapshot, edit: Edit, watch: _Watch) -> Update:
        shown = self._shown
        live: numbers.Live = {}
        touched: list[Touched] = []
        if shown is not None and edit.structure:
            live = numbers.carried(shown.live, shown.snapshot, snapshot)
        elif shown is not None:
            live = {key: made for key, made in shown.live.items() if numbers.is_within(snapshot.literal(key), made)}
            before = shown.snapshot
            pairs = {key: (before.literal(key), snapshot.literal(key)) for key in edit.literals}
            touched = [
                Touched(key, numbers.ranges(*pair))
                for key, pair in pairs.items()
                if key not in live and key not in shown.declared and key not in shown.fixed
            ]
        same = shown if shown is not None and not edit.structure else None
        built = build(snapshot, self._options(), live, touched, same)
        known = self._recent.get(built.code)
        if known is not None:  # where comments differ, the driver would compile for nothing
            built = replace(built, compiled=_in_the_words_of(known, built.compiled))
        watch.took("compiling")
        self._show(built, {}, watch)
        speed = Speed.SAME_SHADER if known is not None else Speed.NEW_SHADER
        return Update(speed, watch.times, len(built.live), built.compiled.scene.warnings)

    def _options(self) -> Options:
        """As `render` would, for a picture that is no long work."""
        rays = self.renderer.rays
        return Options(rays=rays) if self.tracer == AUTO else Options(tracer=self.tracer, rays=rays)

    def _show(self, built: Built, values: dict[str, tuple[float, ...]], watch: _Watch) -> None:
        params = {p.name: p.default for p in built.compiled.scene.params} | values
        image = self._drawn(Shot(built.compiled, View(), params, self.size), built.code)
        watch.took("drawing")
        write_files(image, self.output, "npy")
        watch.took("writing")
        self._shown, self._values = built, values

    def _drawn(self, shot: Shot, code: str) -> Image:
        try:
            colour = self.renderer.radiance(shot, 0, None)[..., :3]
        except DeviceError:
            self.close()
            raise
        self._recent.pop(code, None)
        self._recent[code] = shot.compiled
        while len(self._recent) > _PROGRAMS_KEPT:
            del self._recent[next(iter(self._recent))]
        if isinstance(self._renderer, GlRenderer):
            self._renderer.keep([text for compiled in self._recent.values() for text in compiled.printed(ENTRY)])
        return Image(colour.astype("float32"), {}, shot.compiled.materials, self.renderer.name)

    def distrust(self) -> None:
        """What is shown may not be what was read: the next update begins anew."""
        self._shown = None

    def close(self) -> None:
        """Give the device back. The next picture opens another."""
        renderer, self._renderer, self._recent = self._renderer, None, {}
        if renderer is not None:
            renderer.close()


def _is_quick(shown: Built, snapshot: Snapshot, edit: Edit) -> bool:
    """Whether what is compiled can show the edit: only uniforms change, and what they may be."""
    if edit.structure:
        return False
    scene = shown.compiled.scene
    if edit.camera and (scene.camera is None or not scene.lights):  # without lights, the sun stands behind the camera
        return False
    bound = [(key, shown.bound(key)) for key in edit.literals]
    return all(made is not None and numbers.is_within(snapshot.literal(key), made) for key, made in bound)


def _touched_last(shown: Built, edit: Edit) -> numbers.Live:
    """The live literals with those that were just edited at the end."""
    moved = {key: made for key, made in shown.live.items() if key in edit.literals}
    return {key: made for key, made in shown.live.items() if key not in moved} | moved


def _in_the_words_of(known: Compiled, new: Compiled) -> Compiled:
    """The new scene with the texts of shaders that are on the device."""
    return replace(known, scene=new.scene, plan=new.plan, setting=new.setting, shape=new.shape, frame=new.frame)
