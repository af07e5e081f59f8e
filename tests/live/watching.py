"""`sdfc watch` as a process."""

from __future__ import annotations

import queue
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import Self

PATIENCE = 30.0  # seconds, for a machine with much else to do
FILE = ("-o", "o.png", "--size", "64x36")


class Watching:
    """The process, and what it says."""

    def __init__(self, folder: Path, arguments: tuple[str, ...] = FILE) -> None:
        self.folder = folder
        command = [sys.executable, "-m", "sdfc", "watch", "s.sdf", *arguments]
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.said: queue.Queue[str] = queue.Queue()
        self.all: list[str] = []
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said.put(line.rstrip("\n"))

    def hears(self, words: str) -> str:
        """The next line with these words in it; those before it are passed over."""
        until = time.monotonic() + PATIENCE
        while True:
            try:
                line = self.said.get(timeout=max(0.0, until - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"it never said {words!r}, but: {self.all}") from None
            self.all.append(line)
            if words in line:
                return line

    def picture(self) -> bytes:
        return (self.folder / "o.png").read_bytes()

    def ends(self, number: signal.Signals) -> int:
        self.process.send_signal(number)
        return self.process.wait(PATIENCE)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
