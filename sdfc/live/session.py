"""One scene through many edits: what each needs, done and shown; what is old, released."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from sdfc.api.files import write_files
from sdfc.api.renderer import Renderer, Shot
from sdfc.api.request import AUTO, View, checked_size, checked_tracer
from sdfc.live.edits import Edits, Shown
from sdfc.live.painter import Painter
from sdfc.live.saves import Bell
from sdfc.live.snapshot import Snapshot
from sdfc.live.update import Speed, Stopwatch, Update
from sdfc.pipeline import Options

if TYPE_CHECKING:
    from sdfc.live.pages import Pages
    from sdfc.live.worker import Worker

__all__ = ["Session", "Speed", "Update"]


@dataclass(frozen=True, slots=True)
class _Waiting:
    """What is to be drawn as soon as its shader is compiled."""

    shown: Shown
    watch: Stopwatch
    is_trusted: bool = True  # whether it is what was read


class Session:
    """Shows the snapshots of one scene, one after the other: in a file, on pages, or both."""

    def __init__(
        self,
        output: Path | None,
        size: tuple[int, int],
        tracer: str,
        backend: str,
        note: Callable[[str], None],
        pages: Pages | None = None,
        worker: Worker | None = None,
        bell: Bell | None = None,
    ) -> None:
        self.output = output
        self.size = checked_size(size)
        self.tracer = checked_tracer(tracer)
        self.bell = bell or Bell()  # rung when there is something to do
        self._pages = pages
        self._edits = Edits(self._options)
        self._painter = Painter(backend, note, worker, self.bell.ring, self._edits.forget)
        self._waiting: _Waiting | None = None
        self._is_first = True  # nothing was shown yet

    @property
    def renderer(self) -> Renderer:
        """What draws."""
        return self._painter.renderer

    def update(self, snapshot: Snapshot) -> Update:
        """Show the snapshot, however long it takes. Raises as `begin` does."""
        shown, watch = self._next(snapshot)
        self._tell_pages(shown, watch)
        return self._finish(shown, watch)

    def begin(self, snapshot: Snapshot) -> Update | None:
        """Show the snapshot, or None where its shader is compiled ahead: then `go_on` does, unless another comes first.

        Raises what is wrong with the snapshot, the device or the file, and goes on showing the last.
        """
        shown, watch = self._next(snapshot)
        is_drawn = self.output is not None and shown.speed is not Speed.NOTHING
        has_time = not self._is_first or self._pages is not None  # there is something to do meanwhile
        must_wait = is_drawn and has_time and not self._painter.is_ready(self._shot(shown))
        self._tell_pages(shown, watch)
        if not must_wait:
            return self._finish(shown, watch)
        self._waiting = _Waiting(shown, watch)
        return None

    def go_on(self) -> Update | None:
        """Finish what was begun, if its shader is there."""
        waiting, self._waiting = self._waiting, None
        if waiting is None:
            return None
        if not self._painter.is_ready(self._shot(waiting.shown)):
            self._waiting = waiting
            return None
        waiting.watch.took("compiling ahead")
        update = self._finish(waiting.shown, waiting.watch)
        if not waiting.is_trusted:
            self._edits.distrust()
        return update

    def greet(self) -> None:
        """Tell pages that have come since what is shown."""
        if self._pages is not None:
            self._pages.greet()

    def answer(self, is_needed: Callable[[], bool] = lambda: False) -> bool:
        """Draw for one page that asks for a picture, if there is one; whether there was.

        `is_needed` is asked now and then: where there is a save to be shown, the page is drawn for after it.
        """
        return self._pages is not None and self._pages.answer(self._painter, is_needed)

    def _next(self, snapshot: Snapshot) -> tuple[Shown, Stopwatch]:
        """What is to be shown now. What waits is given up, or goes on to wait with other numbers."""
        watch, waiting = Stopwatch(), self._waiting
        base = waiting.shown if waiting is not None and waiting.is_trusted else None
        shown = self._edits.next(snapshot, watch, base)
        if waiting is not None and shown.built.code == waiting.shown.built.code:
            shown, watch = replace(shown, speed=waiting.shown.speed), waiting.watch
        self._painter.give_up(but=shown.built.compiled)
        self._waiting = None
        return shown, watch

    def _tell_pages(self, shown: Shown, watch: Stopwatch) -> None:
        if self._pages is not None:
            self._pages.show(shown)
            if shown.speed is not Speed.NOTHING:
                watch.took("sending")

    def _finish(self, shown: Shown, watch: Stopwatch) -> Update:
        if self.output is not None and shown.speed is not Speed.NOTHING:
            self._write(self.output, shown, watch)
        self._edits.keep(shown)
        self._is_first = False
        self._painter.keep(self._edits.recent)
        is_compiled = shown.speed in (Speed.SAME_SHADER, Speed.NEW_SHADER)
        warnings = shown.built.compiled.scene.warnings if is_compiled else ()
        return Update(shown.speed, watch.times, len(shown.built.live), warnings)

    def _write(self, output: Path, shown: Shown, watch: Stopwatch) -> None:
        image = self._painter.draw(self._shot(shown))
        watch.took("drawing")
        write_files(image, output, "npy", quick=True)
        watch.took("writing")

    def _shot(self, shown: Shown) -> Shot:
        return Shot(shown.built.compiled, View(), shown.params, self.size)

    def _options(self) -> Options:
        """As `render` would, for a picture that is no long work; as `emit-glsl` would, where only pages draw."""
        if self.output is None:
            return Options() if self.tracer == AUTO else Options(tracer=self.tracer)
        rays = self.renderer.rays
        return Options(rays=rays) if self.tracer == AUTO else Options(tracer=self.tracer, rays=rays)

    def distrust(self) -> None:
        """What is shown may not be what was read: the next update begins anew."""
        self._edits.distrust()
        if self._waiting is not None:
            self._waiting = replace(self._waiting, is_trusted=False)

    def close(self) -> None:
        """Give the device back. The next picture opens another."""
        self._painter.give_up()
        self._edits.forget()
        self._painter.close()
