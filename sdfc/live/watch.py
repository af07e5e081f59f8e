"""The loop of `sdfc watch`: a save, a look at the files, an update; and whatever goes wrong, the next save."""

from __future__ import annotations

import os
import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from sdfc.api.request import RequestError
from sdfc.api.source import STDIN, Kind
from sdfc.diagnostics import SceneError
from sdfc.live.saves import Saves
from sdfc.live.session import Session
from sdfc.live.snapshot import Snapshot, take
from sdfc.live.update import Update

_LOOK = 1.0  # seconds between looks where no event comes: some file systems send none
_SETTLING = 0.1  # seconds that a file may be missing or half written before that is an error


@dataclass(frozen=True, slots=True)
class Failure:
    """A save whose picture could not be made; the last one stays."""

    error: Exception


Stamp = tuple[tuple[int, int, int] | None, ...]


def watch(scene: Path, kind: Kind | None, session: Session) -> Iterator[Update | Failure]:
    """An update for every save, the first picture first, for ever. Raises RequestError where there is no scene."""
    with Saves(session.bell) as saves:
        paths = _watched(saves, scene, first_look(scene, kind), ())
        stamp = _stamp(paths)
        seen = _looked(scene, kind)  # after the stamp: what is saved from now on is seen by the next look
        is_owed = yield from _answered(_told(scene, kind, session, seen))
        is_busy = False

        def is_saved() -> bool:
            return _stamp(paths) != stamp

        while True:
            happened = saves.wait(0.0 if is_busy else _LOOK)
            if not happened and not is_saved():
                is_owed = (yield from _answered(_gone_on(session))) or is_owed
                is_busy = session.answer(is_saved)  # one picture at a time: a save comes first
                continue
            is_busy = True  # the bell may have been rung for more than the save
            before, stamp = stamp, _stamp(paths)  # before the look: what is saved during it is seen by the next one
            now = _settled(scene, kind, _looked(scene, kind))
            paths = _watched(saves, scene, now, paths)
            if _is_same(seen, now) and not (is_owed and stamp != before):
                continue
            seen = now
            is_owed = yield from _answered(_told(scene, kind, session, seen))


def _answered(updates: Iterator[Update | Failure]) -> Generator[Update | Failure, None, bool]:
    """The updates; returns whether a picture is owed through no fault of the scene: its text saved again is tried."""
    is_owed = False
    for told in updates:
        yield told
        match told:
            case Failure(error=SceneError() | RequestError()):
                pass
            case Failure():
                is_owed = True
            case _:
                pass
    return is_owed


def first_look(scene: Path, kind: Kind | None) -> Snapshot | Exception:
    """The scene's files, or what is wrong with them. Raises RequestError where there is nothing to watch."""
    if str(scene) == STDIN:
        raise RequestError("standard input cannot be watched: give the scene's file")
    seen = _looked(scene, kind)
    if isinstance(seen, RequestError):
        raise seen
    return seen


def _looked(scene: Path, kind: Kind | None) -> Snapshot | Exception:
    try:
        return take(scene, kind)
    except (RequestError, SceneError) as error:
        return error


def _settled(scene: Path, kind: Kind | None, seen: Snapshot | Exception) -> Snapshot | Exception:
    """The look, or one a little later where the scene's file was not there: an editor is replacing it."""
    until = time.monotonic() + _SETTLING
    while isinstance(seen, Exception) and time.monotonic() < until:
        time.sleep(_SETTLING / 5)
        seen = _looked(scene, kind)
    return seen


def _told(scene: Path, kind: Kind | None, session: Session, seen: Snapshot | Exception) -> Iterator[Update | Failure]:
    """The update for what was seen. Nothing where it is wrong and already otherwise: it was half written."""
    try:
        if isinstance(seen, Exception):
            raise seen
        update = session.begin(seen)
        if not _is_read_alike(seen, _looked(scene, kind)):
            session.distrust()
        if update is not None:
            yield update
    except SceneError as error:
        time.sleep(_SETTLING)
        if _is_same(seen, _looked(scene, kind)):
            yield Failure(error)
    except Exception as error:  # a device, a full disk, a bug in sdfc: none of them ends the watch
        yield Failure(error)


def _gone_on(session: Session) -> Iterator[Update | Failure]:
    """The update for what was waiting for its shader, if that is there now; and those who have come are greeted."""
    try:
        update = session.go_on()
        if update is not None:
            yield update
        session.greet()
    except Exception as error:  # as above
        yield Failure(error)


def _is_read_alike(before: Snapshot, now: Snapshot | Exception) -> bool:
    """Whether the files that the compiler reads itself, imports and tables, were still those that were looked at."""
    own = before.given.source.name
    others = {name: content for name, content in before.contents.items() if name != own}
    return isinstance(now, Snapshot) and all(now.contents.get(name) == content for name, content in others.items())


def _is_same(before: Snapshot | Exception, now: Snapshot | Exception) -> bool:
    if isinstance(before, Snapshot) and isinstance(now, Snapshot):
        return before.contents == now.contents
    return str(before) == str(now) if isinstance(before, Exception) and isinstance(now, Exception) else False


def _watched(saves: Saves, scene: Path, seen: Snapshot | Exception, before: tuple[Path, ...]) -> tuple[Path, ...]:
    """Watch where the scene's files are (while it cannot be read: where they were); returns what is looked at."""
    if isinstance(seen, Snapshot):
        saves.look_at(seen.folders)
        return seen.looked_at
    paths = before or (scene.absolute(),)
    saves.look_at({path.parent for path in paths})
    return paths


def _stamp(paths: tuple[Path, ...]) -> Stamp:
    return tuple(_state(path) for path in paths)


def _state(path: Path) -> tuple[int, int, int] | None:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
