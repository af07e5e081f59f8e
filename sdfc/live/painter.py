"""Draws what is shown, on a device that is opened when there is something to draw: into a file, or for a page."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from sdfc.api.program import open_renderer
from sdfc.api.renderer import GlRenderer, Renderer, Shot, is_near
from sdfc.diagnostics import DeviceError
from sdfc.image.picture import Image
from sdfc.live.build import ENTRY
from sdfc.live.worker import Outcome, Worker, job_of
from sdfc.pipeline import Compiled

_LONG = 2.0  # seconds that a compile may go on that nobody waits for: then it is stopped, and a new process started


class StoppedError(Exception):
    """A picture was given up before it was done."""


@dataclass(frozen=True, slots=True, eq=False)
class _Ahead:
    """A job that the worker was given, and when."""

    future: Future[Outcome]
    since: float

    @property
    def is_long(self) -> bool:
        return time.monotonic() - self.since > _LONG


class Painter:
    """One device, and the shaders on it. For one thread: a context of OpenGL is its thread's.

    With a worker, shaders are compiled ahead, while this thread does something else: `is_ready` says when.
    """

    def __init__(
        self,
        backend: str,
        note: Callable[[str], None],
        worker: Worker | None,
        ring: Callable[[], None],
        lost: Callable[[], None],
    ) -> None:
        self._backend = backend
        self._note = note
        self._worker = worker
        self._ring = ring  # called, in another thread, when something has become ready
        self._lost = lost  # called when the device failed, and all shaders on it are gone
        self._renderer: Renderer | None = None
        self._ready: set[str] = set()  # shaders that this process has, or finds in the driver's cache
        self._ahead: dict[str, _Ahead] = {}
        self._left: list[_Ahead] = []  # what nobody waits for any more, and others wait behind

    @property
    def renderer(self) -> Renderer:
        """What draws; opened at the first picture, and again after it failed."""
        if self._renderer is None:
            self._renderer = open_renderer(self._backend, self._note)
        return self._renderer

    def is_ready(self, shot: Shot) -> bool:
        """Whether to draw it takes no compiling; if not, that is begun elsewhere, and `ring` called when it is done."""
        worker = self._worker
        if worker is None or not worker.helps or not isinstance(self.renderer, GlRenderer):
            return True
        shader = _shader(shot)
        if shader in self._ready:
            return True
        if shader not in self._ahead:
            self._ahead[shader] = _Ahead(worker.compile(job_of(shot, ENTRY)), time.monotonic())
            self._ahead[shader].future.add_done_callback(lambda _: self._ring())
        if not self._ahead[shader].future.done():
            self._stop_what_was_left()
            return False
        del self._ahead[shader]
        self._ready.add(shader)  # whatever came of it: what is wrong with a shader is seen when it is drawn
        return True

    def give_up(self, but: Compiled | None = None) -> None:
        """Nobody waits any more for what is being compiled, if it is not a shader of that scene."""
        kept = but.printed(ENTRY) if but is not None else []
        left = [self._ahead.pop(shader) for shader in self._ahead.keys() - set(kept)]
        self._left += [job for job in left if not job.future.cancel()]
        self._stop_what_was_left()

    def _stop_what_was_left(self) -> None:
        self._left = [job for job in self._left if not job.future.done()]
        if self._worker is not None and any(job.is_long for job in self._left):
            self._left.clear()
            self._worker.stop()

    def draw(self, shot: Shot, is_over: Callable[[], bool] | None = None) -> Image:
        """The picture of one sample a pixel. Raises DeviceError, and then begins anew with the next one.

        `is_over` is asked now and then whether the picture is to be given up: then it raises StoppedError.
        """

        def go_on(_: float) -> None:
            if is_over is not None and is_over():
                raise StoppedError

        try:
            colour = self.renderer.radiance(shot, 0, go_on)[..., :3]
        except DeviceError:
            self.close()
            self._lost()
            raise
        self._ready.add(_shader(shot))
        return Image(colour.astype("float32"), {}, shot.compiled.materials, self.renderer.name)

    def keep(self, scenes: Sequence[Compiled]) -> None:
        """Release the shaders of all others."""
        kept = [text for compiled in scenes for text in compiled.printed(ENTRY)]
        self._ready.intersection_update(kept)
        if isinstance(self._renderer, GlRenderer):
            self._renderer.keep(kept)

    def close(self) -> None:
        """Give the device back. The next picture opens another."""
        renderer, self._renderer, self._ready = self._renderer, None, set()
        if renderer is not None:
            renderer.close()


def _shader(shot: Shot) -> str:
    """The one that a driver takes its time for."""
    uniforms = shot.compiled.uniforms(shot.view, shot.params, shot.size)
    return shot.compiled.glsl(ENTRY, "fragment", is_near(uniforms))
