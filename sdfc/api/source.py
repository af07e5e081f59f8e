"""Where scenes come from: a text, a file, standard input."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal, TypeAlias

from sdfc.api.request import RequestError
from sdfc.diagnostics import Source, scene_error

Kind: TypeAlias = Literal["sdf", "csg"]

KINDS: tuple[Kind, ...] = ("sdf", "csg")
STDIN = "-"
LARGEST_FILE = 64 << 20  # bytes; each language has its own, lower, limits: this one keeps /dev/zero from filling memory


@dataclass(frozen=True, slots=True)
class Input:
    """A scene's text, its language, and the folder that its imports are looked up in (None: it may not import)."""

    source: Source
    kind: Kind
    folder: Path | None = None


def from_text(text: str, kind: Kind = "sdf", name: str = "<text>") -> Input:
    """A scene that is at hand as text."""
    return Input(Source(name, text), kind)


def from_path(path: str | Path, kind: Kind | None = None) -> Input:
    """A scene file, or standard input for `-`. Its ending says the language where `kind` does not."""
    if str(path) == STDIN:
        return Input(Source("<stdin>", _decoded(_read(sys.stdin.buffer), "<stdin>")), kind or "sdf", Path.cwd())
    path = Path(path)
    try:
        with open(path, "rb") as file:
            data = _read(file)
    except OSError as error:
        raise RequestError(f"cannot read '{path}': {error.strerror}") from error
    text = _decoded(data, str(path))
    return Input(Source(str(path), text), kind or _kind_of(path), path.resolve().parent)


def looks_like_path(text: str) -> bool:
    """Whether a string is the name of a scene file: no scene is one line that ends like one."""
    return "\n" not in text and text.lower().endswith(tuple(f".{kind}" for kind in KINDS))


def _kind_of(path: Path) -> Kind:
    return "csg" if path.suffix.lower() == ".csg" else "sdf"


def _read(file: BinaryIO) -> bytes:
    return file.read(LARGEST_FILE + 1)


def _decoded(data: bytes, name: str) -> str:
    if len(data) > LARGEST_FILE:
        raise scene_error(f"{name} is larger than {LARGEST_FILE >> 20} MiB")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise scene_error(f"{name} is not UTF-8 text (byte {data[error.start]:#04x} in line {line})") from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def kind_named(name: str | None) -> Kind | None:
    """The language of that name."""
    return next((kind for kind in KINDS if kind == name), None)
