"""Where sdfc keeps between runs what it can make again. Losing it loses time, never a result."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
from pathlib import Path
from typing import Any


def folder() -> Path:
    """SDFC_CACHE_DIR, else the platform's folder for caches, else (a user without a home) a temporary one."""
    given = os.environ.get("SDFC_CACHE_DIR", "")
    if given:
        return Path(given).absolute()
    try:
        home = Path.home()
    except RuntimeError:  # a daemon's, a container's user
        from tempfile import gettempdir

        return Path(gettempdir()) / "sdfc"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "sdfc" / "cache"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "sdfc"
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else home / ".cache") / "sdfc"


def recall(kind: str, key: str) -> Any:
    """The JSON value that was remembered of a key, or None; what cannot be read was never there."""
    with contextlib.suppress(ValueError):
        return json.loads(recall_bytes(kind, key) or "null")
    return None


def remember(kind: str, key: str, value: Any) -> None:
    """Keep a JSON value for later runs, where the folder can be written."""
    remember_bytes(kind, key, json.dumps(value).encode())


def recall_bytes(kind: str, key: str) -> bytes | None:
    """What was remembered of a key, or None; what cannot be read was never there, nor was what another user wrote."""
    with contextlib.suppress(OSError), _path(kind, key).open("rb") as file:
        if sys.platform == "win32" or os.fstat(file.fileno()).st_uid == os.getuid():
            return _whole(file.read())
    return None


def remember_bytes(kind: str, key: str, value: bytes) -> None:
    """Keep a value for later runs, where the folder can be written. Written aside, then renamed: never half."""
    from tempfile import NamedTemporaryFile

    path = _path(kind, key)
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=path.parent, delete=False) as file, contextlib.ExitStack() as left:
            left.callback(os.unlink, file.name)  # where the disk is full
            file.write(_digest(value) + value)
            file.close()
            os.replace(file.name, path)
            left.pop_all()


def _digest(value: bytes) -> bytes:
    return hashlib.sha256(value).digest()


def _whole(kept: bytes) -> bytes | None:
    """What was written, or None: bytecode that is damaged ends the process, or makes other GLSL."""
    size = len(_digest(b""))
    return kept[size:] if _digest(kept[size:]) == kept[:size] else None


def _path(kind: str, key: str) -> Path:
    return folder() / kind / hashlib.sha256(key.encode()).hexdigest()[:32]
