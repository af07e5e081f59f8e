"""Moving pictures in one file: what can be written, by the ending of the file's name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

FILM_FORMATS = ("gif", "mp4")


class Film(Protocol):
    """A film in the making."""

    def add(self, pixels: NDArray[np.uint8]) -> None:
        """The next picture, (height, width, 3), rows from the top, all of one size."""

    def finish(self) -> bytes:
        """The whole file."""

    def close(self) -> None:
        """Drop what is unfinished."""


def is_film(path: Path) -> bool:
    """Whether a file of that name holds moving pictures."""
    return path.suffix.lower().removeprefix(".") in FILM_FORMATS


def new_film(path: Path, size: tuple[int, int], fps: float) -> Film:
    """A film of `size` (width, height) for a file of that name. Raises OutputError where it could not be made."""
    return _MAKERS[path.suffix.lower().removeprefix(".")](size, fps)


def _gif(size: tuple[int, int], fps: float) -> Film:
    from sdfc.image.gif import Gif

    return Gif(size, fps)


def _mp4(size: tuple[int, int], fps: float) -> Film:
    from sdfc.image.video import Mp4

    return Mp4(size, fps)


_MAKERS: dict[str, Callable[[tuple[int, int], float], Film]] = {"gif": _gif, "mp4": _mp4}
