"""A session whose shaders are compiled beside it, when a test says so."""

from __future__ import annotations

from concurrent.futures import Future
from pathlib import Path
from typing import cast

from author import SIZE

from sdfc.live.pages import Pages
from sdfc.live.saves import Bell
from sdfc.live.session import Session
from sdfc.live.snapshot import take
from sdfc.live.update import Update
from sdfc.live.worker import Job, Outcome, Worker


class SlowWorker:
    """Takes jobs, and is done with them when a test says so."""

    def __init__(self) -> None:
        self.helps = True
        self.jobs: list[tuple[Job, Future[Outcome]]] = []
        self.stops = 0

    def compile(self, job: Job) -> Future[Outcome]:
        future: Future[Outcome] = Future()
        self.jobs.append((job, future))
        return future

    def stop(self) -> None:
        self.stops += 1

    def finishes(self, outcome: Outcome = Outcome.KEPT) -> None:
        """All that it was not told to leave."""
        for _, future in self.jobs:
            if not future.done():
                future.set_result(outcome)


class Desk:
    """A session with a worker, for one who looks at the file."""

    def __init__(self, folder: Path, pages: Pages | None = None, has_file: bool = True) -> None:
        self.scene, self.file = folder / "s.sdf", folder / "o.npy"
        self.worker, self.bell = SlowWorker(), Bell()
        output = self.file if has_file else None
        self.session = Session(output, SIZE, "auto", "gl", print, pages, cast("Worker", self.worker), self.bell)

    def begins(self, text: str) -> Update | None:
        self.scene.write_text(text)
        return self.session.begin(take(self.scene))

    def picture(self) -> bytes:
        return self.file.read_bytes()
