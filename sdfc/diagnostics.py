"""Places in a source, what is wrong there, and how that is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """One text that was read: a scene file, an import, standard input, a standard-library file."""

    name: str
    text: str

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, from 1, of a character offset."""
        line_start = self.text.rfind("\n", 0, offset) + 1
        return self.text.count("\n", 0, offset) + 1, offset - line_start + 1


@dataclass(frozen=True, slots=True)
class Span:
    """Characters start (included) to end (excluded) of a source."""

    source: Source
    start: int
    end: int

    def __str__(self) -> str:
        line, column = self.source.position(self.start)
        return f"{self.source.name}:{line}:{column}"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One thing to tell the author of a scene."""

    message: str
    span: Span | None = None
    hint: str | None = None
    severity: Literal["error", "warning"] = "error"


class SceneError(Exception):
    """The scene is wrong. Carries every diagnostic found; the only error that a scene can raise."""

    def __init__(self, *diagnostics: Diagnostic) -> None:
        super().__init__("\n".join(d.message for d in diagnostics))
        self.diagnostics = diagnostics


class InternalError(Exception):
    """A bug in sdfc: reported as one, exit code 70."""


class DeviceError(Exception):
    """There is no usable OpenGL device, or it failed; exit code 3."""


def scene_error(message: str, span: Span | None = None, hint: str | None = None) -> SceneError:
    """A SceneError with one diagnostic."""
    return SceneError(Diagnostic(message, span, hint))


def _excerpt(span: Span, hint: str | None) -> list[str]:
    line_number, column = span.source.position(span.start)
    text = span.source.text.split("\n")[line_number - 1].rstrip("\r")
    width = max(1, min(span.end - span.start, len(text) - column + 1))
    if len(text) > 160:  # keep the caret on a terminal: show a window of a very long line
        first = max(0, column - 60)
        text, column = text[first : first + 120], column - first
        width = max(1, min(width, 120 - column + 1))
    pointed = "".join("\t" if c == "\t" else " " for c in text[: column - 1]) + "^" * width
    gutter = f"{line_number:5d} | "
    return [gutter + text, " " * (len(gutter) - 2) + "| " + pointed + (f" {hint}" if hint else "")]


def show(diagnostic: Diagnostic) -> str:
    """The diagnostic as a user reads it: `file:line:column: error: message`, the line, a caret with the hint."""
    if diagnostic.span is None:
        tail = f"\n  {diagnostic.hint}" if diagnostic.hint else ""
        return f"{diagnostic.severity}: {diagnostic.message}{tail}"
    head = f"{diagnostic.span}: {diagnostic.severity}: {diagnostic.message}"
    return "\n".join([head, *_excerpt(diagnostic.span, diagnostic.hint)])


def show_all(diagnostics: Sequence[Diagnostic], most: int = 20) -> str:
    """Several diagnostics, in order of place, at most `most` of them."""
    shown = [show(d) for d in diagnostics[:most]]
    if len(diagnostics) > most:
        shown.append(f"... and {len(diagnostics) - most} more")
    return "\n".join(shown)
