"""Where sdfc keeps between runs what it can make again. Losing it loses time, never a result."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any


def folder() -> Path:
    """SDFC_CACHE_DIR, else the platform's folder for caches, else (a user without a home) a temporary one."""
    given = os.environ.get("SDFC_CACHE_DIR", "")
    if os.path.isabs(given):
        return Path(given)
    try:
        home = Path.home()
    except RuntimeError:  # a daemon's, a container's user
        return Path(tempfile.gettempdir()) / "sdfc"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "sdfc" / "cache"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "sdfc"
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else home / ".cache") / "sdfc"


def recall(kind: str, key: str) -> Any:
    """The JSON value that was remembered of a key, or None; what cannot be read was never there."""
    with contextlib.suppress(OSError, ValueError):
        return json.loads(_path(kind, key).read_text(encoding="utf-8"))
    return None


def remember(kind: str, key: str, value: Any) -> None:
    """Keep a JSON value for later runs, where the folder can be written. Written aside, then renamed: never half."""
    path = _path(kind, key)
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False, encoding="utf-8") as file:
            json.dump(value, file)
        os.replace(file.name, path)


def _path(kind: str, key: str) -> Path:
    return folder() / kind / f"{hashlib.sha256(key.encode()).hexdigest()[:32]}.json"
