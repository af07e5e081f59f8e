"""The parser's tables, kept between runs: making them from the grammar takes longer than parsing most scenes."""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
from pathlib import Path

from lark import Lark, __version__

from sdfc.cache import folder


def load(grammar: str, callbacks: object) -> Lark:
    """An LALR parser of `grammar` that calls `callbacks` (methods named as its rules) as it reduces."""
    path = _place(grammar)
    kept = _kept(path, callbacks)
    if kept is not None:
        return kept
    made = Lark(grammar, parser="lalr", transformer=callbacks)
    _keep(made, path)
    return made


def _place(grammar: str) -> Path:
    key = "\0".join([grammar, __version__, sys.version]).encode()
    return folder() / f"grammar-{hashlib.sha256(key).hexdigest()[:32]}.tables"


def _kept(path: Path, callbacks: object) -> Lark | None:
    try:
        with path.open("rb") as file:
            # what Lark.load does, which has no way to give the callbacks
            return Lark.__new__(Lark)._load(pickle.load(file), transformer=callbacks)
    except Exception:  # damaged in any way: a pickle raises anything. It is made and written again
        return None


def _keep(parser: Lark, path: Path) -> None:
    """Written aside, then renamed: another process never sees half a file. Where nothing can be written, nothing is."""
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            parser.save(file)
        os.replace(file.name, path)
