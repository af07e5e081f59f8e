"""Somebody who edits a scene that pages show."""

from __future__ import annotations

import threading
import time
from pathlib import Path

from author import SIZE
from visitor import PATIENCE

from sdfc.diagnostics import SceneError, show_all
from sdfc.live.pages import Pages
from sdfc.live.saves import Bell
from sdfc.live.session import Session
from sdfc.live.snapshot import take
from sdfc.live.update import Update


class Host:
    """Somebody who edits a scene that pages show."""

    def __init__(self, folder: Path, picture: Path | None) -> None:
        self.bell = Bell()
        self.asked = threading.Semaphore(0)
        self.pages = Pages(0, self.asked.release)
        self.port = int(self.pages.address.rstrip("/").rsplit(":", 1)[1])
        self.scene = folder / "s.sdf"
        self.session = Session(picture, SIZE, "auto", "gl", print, self.pages, bell=self.bell)

    def save(self, text: str) -> Update:
        """As the watch does it."""
        self.scene.write_text(text)
        try:
            update = self.session.update(take(self.scene))
        except SceneError as error:
            self.pages.tell_errors(show_all(error.diagnostics), error)
            self.pages.tell("broken")
            raise
        self.pages.tell(update.speed.value)
        return update

    def answers(self) -> None:
        """One wish that was made, or is being made."""
        until = time.monotonic() + PATIENCE
        while not self.session.answer():
            assert self.asked.acquire(timeout=until - time.monotonic())

    def close(self) -> None:
        self.pages.close()
        self.session.close()
