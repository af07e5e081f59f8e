"""What costly searches found, kept from one compilation to the next: an edit elsewhere searches for nothing again."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from sdfc.field.graph import Expr, Op, topological

Found = TypeVar("Found")
MOST = 1024  # numbers: of hundreds of parts


class Memory(Generic[Found]):
    """The last answers of a search, by all that it depends on. Answers are values that no compilation owns."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._found: OrderedDict[Hashable, Found] = OrderedDict()
        self._lock = threading.Lock()  # scenes may be compiled in several threads

    def recall(self, question: Hashable, search: Callable[[], Found]) -> Found:
        """What `search` gives, or gave when the question was asked before."""
        with self._lock:
            if question in self._found:
                self._found.move_to_end(question)
                return self._found[question]
        answer = search()
        with self._lock:
            self._found[question] = answer
            if len(self._found) > self._most:
                self._found.popitem(last=False)
        return answer


def fingerprint(roots: Iterable[Expr]) -> Hashable:
    """Equal for expressions that are the same formulas, in whatever graphs."""
    wanted = list(roots)
    place: dict[int, int] = {}
    nodes: list[Hashable] = []
    for node in topological(wanted):
        place[node.id] = len(nodes)
        value = repr(node.value) if node.op is Op.CONST else node.value  # keeps 0.0 and -0.0 apart, and NaN equal
        nodes.append((node.op.value, node.type.value, tuple([place[a.id] for a in node.args]), value))
    return tuple(nodes), tuple([place[root.id] for root in wanted])


def params_fingerprint(params: Mapping[str, ArrayLike]) -> Hashable:
    """Equal for equal values, or ranges, of equal params."""
    return tuple(sorted((name, np.asarray(value, float).tobytes()) for name, value in params.items()))
