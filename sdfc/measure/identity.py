"""What an answer depends on, as one hash: a scene's fields, numbers, arrays, and the code that answers."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import files
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.field.graph import Expr
from sdfc.field.order import evaluation_order
from sdfc.pipeline import Compiled
from sdfc.shape.lower import lower

Array: TypeAlias = NDArray[np.float64]

# what proves; a change in any of them may change an answer
_CODE = {
    "sdfc.field": (".py",),
    "sdfc.reference": ("certify.py", "search.py", "parts.py", "region.py", "closed.py", "sharpen.py", "events.py"),
    "sdfc.measure": ("truth.py", "judge.py"),
    "sdfc.shape": (".py",),
    "sdfc.std": (".sdf",),
}


def digest(compiled: Compiled, distance: Expr, numbers: Sequence[object], arrays: Iterable[Array]) -> str:
    """64 hexadecimal digits: equal only for the same field, scene as written, numbers, arrays and code."""
    with pipeline.deep_recursion():
        written = lower(compiled.scene.root, compiled.scene.values.input("p"))
    state = hashlib.sha256(code_version().encode())
    for root in (distance, written):
        for line in _lines(root):
            state.update(line)
    state.update(repr(tuple(numbers)).encode())
    for array in arrays:
        state.update(repr((array.dtype.str, array.shape)).encode())
        state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()


def _lines(root: Expr) -> Iterable[bytes]:
    """The expression as text, whatever else its graph holds: nodes are numbered from the leaves up."""
    number: dict[int, int] = {}
    for node in evaluation_order([root]):
        number[node.id] = len(number)
        args = " ".join(str(number[a.id]) for a in node.args)
        yield f"{node.op.value} {node.type.value} {args} {node.value!r}\n".encode()


@cache
def code_version() -> str:
    """A hash of the code that proves."""
    state = hashlib.sha256()
    for package, wanted in sorted(_CODE.items()):
        for file in sorted(files(package).iterdir(), key=lambda entry: entry.name):
            if file.name.endswith(wanted):
                state.update(file.name.encode() + file.read_bytes())
    return state.hexdigest()
