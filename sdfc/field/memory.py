"""What costly searches found, kept from one compilation to the next: an edit elsewhere searches for nothing again."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from sdfc.field.graph import Expr, topological

Found = TypeVar("Found")
MOST = 1024  # numbers: of hundreds of parts


class Memory:
    """The last answers of searches, by all that they depend on. Answers are values that no compilation owns."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._found: OrderedDict[Hashable, Any] = OrderedDict()
        self._lock = threading.Lock()  # scenes may be compiled in several threads

    def recall(self, question: Hashable, search: Callable[[], Found]) -> Found:
        """What `search` gives, or gave when the question was asked before."""
        with self._lock:
            if question in self._found:
                self._found.move_to_end(question)
                return cast("Found", self._found[question])
        answer = search()
        with self._lock:
            self._found[question] = answer
            if len(self._found) > self._most:
                self._found.popitem(last=False)
        return answer

    def forget(self) -> None:
        """Nothing was ever asked."""
        with self._lock:
            self._found.clear()


MEMORY = Memory()


def fingerprint(roots: Iterable[Expr]) -> bytes:
    """Equal for expressions that are the same formulas, in whatever graphs; short, however long they are."""
    wanted = list(roots)
    place: dict[int, int] = {}
    text = hashlib.blake2b(digest_size=16)
    for node in topological(wanted):
        place[node.id] = len(place)
        # a constant's repr keeps 0.0 and -0.0 apart, and makes NaN equal to itself
        text.update(f"{node.op.value} {node.type.value} {[place[a.id] for a in node.args]} {node.value!r}\n".encode())
    text.update(repr([place[root.id] for root in wanted]).encode())
    return text.digest()


def params_fingerprint(params: Mapping[str, ArrayLike]) -> Hashable:
    """Equal for equal values, or ranges, of equal params."""
    return tuple(sorted((name, np.asarray(value, float).tobytes()) for name, value in params.items()))
