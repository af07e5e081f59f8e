"""An animation's files: one a frame, or one film."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

from sdfc.api.files import STDOUT, aov_path, check_files, write_files
from sdfc.api.request import RequestError, checked_size
from sdfc.image.film import FILM_FORMATS, Film, is_film, new_film
from sdfc.image.picture import Image
from sdfc.image.write import check_writable, write

_NUMBER = re.compile(r"%(0?\d{0,2})d")  # as printf has it


class Reel(Protocol):
    """Where the pictures of an animation go."""

    def made_at(self, frame: int) -> float | None:
        """When a frame was made (seconds since the epoch), if an earlier run did; else None."""

    def add(self, frame: int, image: Image) -> None:
        """Keep a frame."""

    def finish(self) -> list[Path]:
        """Write what is not yet written; returns the files that were written."""

    def close(self) -> None:
        """Drop what is unfinished."""


class Pictures:
    """A picture for every frame, with its other images beside it: each is written at once, whole."""

    def __init__(self, pattern: Path, aovs: tuple[str, ...], aov_format: str) -> None:
        self._pattern, self._aovs, self._aov_format = pattern, aovs, aov_format
        self._written: list[Path] = []
        check_files(self.path(0), aovs, aov_format)

    def path(self, frame: int) -> Path:
        """The name of a frame's picture."""
        numbered = _NUMBER.sub(lambda found: f"{frame:{found[1]}d}", self._pattern.name.replace("%%", "\0"))
        return self._pattern.with_name(numbered.replace("\0", "%"))

    def made_at(self, frame: int) -> float | None:
        """See Reel: the picture and all that was to be beside it."""
        path = self.path(frame)
        files = [path, *(aov_path(path, name, self._aov_format) for name in self._aovs)]
        return min(file.stat().st_mtime for file in files) if all(file.is_file() for file in files) else None

    def add(self, frame: int, image: Image) -> None:
        """See Reel."""
        self._written += write_files(image, self.path(frame), self._aov_format)

    def finish(self) -> list[Path]:
        """See Reel."""
        return self._written

    def close(self) -> None:
        """Nothing is unfinished."""


class Cinema:
    """One film of all frames, written when it is whole."""

    def __init__(self, path: Path, film: Film) -> None:
        check_writable(path)
        self._path, self._film = path, film

    def made_at(self, frame: int) -> float | None:
        """See Reel: half a film is not kept."""
        return None

    def add(self, frame: int, image: Image) -> None:
        """See Reel."""
        self._film.add(image.pixels)

    def finish(self) -> list[Path]:
        """See Reel."""
        write(self._path, self._film.finish())
        return [self._path]

    def close(self) -> None:
        """See Reel."""
        self._film.close()


def open_reel(
    output: Path, size: tuple[int, int], fps: float, aovs: Iterable[str], aov_format: str, resume: bool
) -> Reel:
    """What `output` asks for. Raises RequestError or OutputError for what could not be written, before it is drawn."""
    wanted = tuple(aovs)
    if output == STDOUT:
        raise RequestError("an animation is not written to standard output: give -o a name")
    if is_film(output):
        if wanted or resume:
            given = "--aov" if wanted else "--resume"
            raise RequestError(f"{given} goes with a picture for every frame, as in -o {output.stem}_%04d.png")
        return Cinema(output, new_film(output, checked_size(size), fps))
    check_pattern(output)
    return Pictures(output, wanted, aov_format)


def check_pattern(output: Path) -> None:
    """Raise RequestError if a name does not say where the frame's number goes: once, as %d or %04d."""
    bare = output.name.replace("%%", "")
    if len(_NUMBER.findall(bare)) != 1 or "%" in _NUMBER.sub("", bare):
        films = " or ".join(f".{ending}" for ending in FILM_FORMATS)
        stem = re.sub(r"[_.-]?%[^_.-]*", "", output.stem) or "out"
        example = f"{stem}_%04d{output.suffix or '.png'}"
        raise RequestError(
            f"'{output}' does not say once where a frame's number goes: write it as in {example} (or one film: {films})"
        )
