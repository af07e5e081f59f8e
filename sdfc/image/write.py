"""Output files that are there whole, or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path


class OutputError(Exception):
    """An output file cannot be written; exit code 2."""


def check_writable(path: Path) -> None:
    """Raise OutputError if `path` can surely not be written: to be asked before hours of rendering, not after."""
    folder = path.parent
    if path.is_dir():
        raise OutputError(f"cannot write '{path}': it is a folder")
    if not folder.exists():
        raise OutputError(f"cannot write '{path}': there is no folder '{folder}'")
    if not folder.is_dir():
        raise OutputError(f"cannot write '{path}': '{folder}' is not a folder")
    special = path.exists() and not path.is_file()
    if not os.access(path if special else folder, os.W_OK):
        raise OutputError(f"cannot write '{path}': permission denied")


def check_no_source(paths: Iterable[Path], sources: Iterable[str]) -> None:
    """Raise OutputError for a file that a scene was read from: a mistyped name must not cost a scene."""
    read = [Path(source) for source in sources if Path(source).exists()]
    for path in paths:
        if path.exists() and any(map(path.samefile, read)):
            raise OutputError(f"cannot write '{path}': the scene was read from it")


def write_all(files: Mapping[Path, bytes]) -> None:
    """Write several files, each whole or not at all; none is put in place before all are on the disk."""
    temporaries: dict[Path, Path] = {}
    try:
        for path, data in files.items():
            _stage(path, data, temporaries)
        for path, temporary in list(temporaries.items()):
            os.replace(temporary, path)
            del temporaries[path]
    except OSError as error:
        raise OutputError(f"cannot write '{error.filename}': {error.strerror}") from error
    finally:  # also on Ctrl-C
        for temporary in temporaries.values():
            with contextlib.suppress(OSError):
                temporary.unlink()


def write(path: Path, data: bytes) -> None:
    """Write one file, whole or not at all."""
    write_all({path: data})


def _stage(path: Path, data: bytes, temporaries: dict[Path, Path]) -> None:
    """Put `data` beside its target (through links: a link stays one) and note it, before a byte is written."""
    target = path.resolve()
    check_writable(target)
    if target.exists() and not target.is_file():  # /dev/null, a pipe: nothing to replace, and it must not be replaced
        try:
            target.write_bytes(data)
        except OSError as error:
            raise OutputError(f"cannot write '{path}': {error.strerror}") from error
        return
    temporary = target.with_name(f".{target.name[:80]}.{os.urandom(4).hex()}.tmp")
    temporaries[target] = temporary
    try:
        with open(temporary, "xb") as file:  # the user's umask decides the rights
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise OutputError(f"cannot write '{path}': {error.strerror}") from error
