"""A progress bar on stderr: for people only, and only for what takes a while."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self, TextIO

_PATIENCE = 1.0  # seconds of silence first
_WIDTH = 30
_REDRAW = 0.1  # seconds


class ProgressBar:
    """Call it with the share done, 0 to 1. Says nothing where `stream` is not a terminal, nor in the first second."""

    def __init__(self, label: str, stream: TextIO | None = None) -> None:
        self._label = label
        self._stream = sys.stderr if stream is None else stream
        self._shown = False
        self._started = time.monotonic()
        self._drawn = 0.0

    def __call__(self, share: float) -> None:
        now = time.monotonic()
        elapsed = now - self._started
        if elapsed < _PATIENCE or now - self._drawn < _REDRAW or not self._stream.isatty():
            return
        self._drawn = now
        self._shown = True
        left = elapsed * (1.0 - share) / share if share > 0.0 else None
        bar = "#" * int(share * _WIDTH)
        self._stream.write(f"\r{self._label} [{bar:<{_WIDTH}}] {share:4.0%}  {duration(left)} left \x1b[K")
        self._stream.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()


def duration(seconds: float | None) -> str:
    """`0:07`, `12:30`, `1:02:03`, or `?` where it is not known."""
    if seconds is None:
        return "?"
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"{hours}:{minutes:02d}:{whole % 60:02d}" if hours else f"{minutes}:{whole % 60:02d}"
