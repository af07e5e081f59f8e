"""Somebody who edits a scene's file, and has each edit drawn."""

from __future__ import annotations

from pathlib import Path

from sdfc.live.session import Session, Update
from sdfc.live.snapshot import take

SIZE = (64, 36)


class Author:
    """Edits a scene's file, and has each edit drawn."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(exist_ok=True)
        self.scene = folder / "s.sdf"
        self.picture = folder / "o.npy"
        self.session = Session(self.picture, SIZE, "auto", "gl", print)

    def save(self, text: str) -> Update:
        self.scene.write_text(text)
        return self.session.update(take(self.scene))
