"""Arrays kept on disk between runs, by a key that says what they are the answer to. A cache: it may always be lost.

Nothing here raises because a disk is full, a file is broken or a folder cannot be written: then there simply is
nothing kept.
"""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sdfc.cache import folder

MOST_BYTES = 500_000_000


def load(kind: str, key: str) -> dict[str, NDArray[np.generic]] | None:
    """What was kept under the key, or None where nothing usable is."""
    path = _path(kind, key)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        os.utime(path)  # used now: what is oldest is removed first
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    return arrays


def save(kind: str, key: str, arrays: Mapping[str, NDArray[np.generic]], most_bytes: int = MOST_BYTES) -> bool:
    """Keep arrays; whether that worked. Others may write the same at the same time: the last one stays, whole."""
    path = _path(kind, key)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(suffix=".part", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
            os.replace(temporary, path)
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
        _trim(path.parent, most_bytes)
    except OSError:
        return False
    return True


def _path(kind: str, key: str) -> Path:
    return folder() / kind / f"{key}.npz"


def _trim(where: Path, most_bytes: int) -> None:
    """Remove what has not been used for longest, until the rest is small enough."""
    files = []
    for path in where.iterdir():
        try:
            found = path.stat()
        except OSError:  # another process removed it
            continue
        files.append((found.st_mtime, found.st_size, path))
    total = sum(size for _, size, _ in files)
    for _, size, path in sorted(files, key=lambda entry: entry[:2]):
        if total <= most_bytes:
            break
        path.unlink(missing_ok=True)
        total -= size
