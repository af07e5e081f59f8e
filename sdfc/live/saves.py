"""When something is saved in some folders: however an editor does it, and once for many events at a time."""

from __future__ import annotations

import threading
from collections.abc import Collection
from pathlib import Path
from types import TracebackType
from typing import Self

_QUIET = 25  # milliseconds without an event: what an editor does for one save is done
_LONGEST = 250  # milliseconds of events without a pause


class Bell:
    """Wakes the one who waits: any thread may ring it."""

    def __init__(self) -> None:
        self._rung = threading.Event()

    def ring(self) -> None:
        self._rung.set()

    def wait(self, seconds: float) -> bool:
        """Until it is rung, or has been since the last time; so long at most. Whether it was."""
        rung = self._rung.wait(seconds)
        self._rung.clear()
        return rung


class Saves:
    """Waits in a thread of its own, so that signals (Ctrl-C) reach the main one as they always do."""

    def __init__(self, bell: Bell) -> None:
        self._folders: frozenset[Path] = frozenset()
        self._bell = bell
        self._happened = threading.Event()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def look_at(self, folders: Collection[Path]) -> None:
        """Watch these folders, without those in them. One that took another's place is another folder."""
        wanted = frozenset(folder for folder in folders if folder.is_dir())
        if wanted == self._folders and self._thread is not None and not self._stop.is_set():
            return
        self.close()
        self._folders, self._stop = wanted, threading.Event()
        self._thread = threading.Thread(target=self._run, args=(wanted, self._stop), daemon=True)
        self._thread.start()

    def wait(self, seconds: float) -> bool:
        """Wait for the bell, so long at most; whether something was saved."""
        self._bell.wait(seconds)
        if not self._happened.is_set():  # cleared only where it is set: a save that comes here rings again
            return False
        self._happened.clear()
        return True

    def _run(self, folders: Collection[Path], stop: threading.Event) -> None:
        from watchfiles import Change, watch

        changes = watch(
            *folders,
            watch_filter=None,
            debounce=_LONGEST,
            step=_QUIET,
            stop_event=stop,
            raise_interrupt=False,
            recursive=False,
            ignore_permission_denied=True,
        )
        try:
            for happened in changes:
                if any(kind is Change.deleted and Path(path) in folders for kind, path in happened):
                    stop.set()  # what comes in its place is another folder
                self._happened.set()
                self._bell.ring()
        except OSError:  # a folder is gone, or the system watches no more: whoever waits looks now and then anyway
            pass
        finally:
            stop.set()

    def close(self) -> None:
        """Stop watching."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()
