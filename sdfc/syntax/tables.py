"""The parser's tables, kept between runs: making them from the grammar takes longer than parsing most scenes."""

from __future__ import annotations

import io
import pickle
import sys

from lark import Lark, __version__

from sdfc.cache import recall_bytes, remember_bytes

KIND = "grammars"


def load(grammar: str, callbacks: object) -> Lark:
    """An LALR parser of `grammar` that calls `callbacks` (methods named as its rules) as it reduces."""
    key = "\0".join([grammar, __version__, sys.version])
    kept = _kept(key, callbacks)
    if kept is not None:
        return kept
    made = Lark(grammar, parser="lalr", transformer=callbacks)
    _keep(made, key)
    return made


def _kept(key: str, callbacks: object) -> Lark | None:
    tables = recall_bytes(KIND, key)
    try:
        # what Lark.load does, which has no way to give the callbacks
        return None if tables is None else Lark.__new__(Lark)._load(pickle.loads(tables), transformer=callbacks)
    except Exception:  # another sdfc's: a pickle raises anything. It is made and written again
        return None


def _keep(parser: Lark, key: str) -> None:
    tables = io.BytesIO()
    parser.save(tables)
    remember_bytes(KIND, key, tables.getvalue())
