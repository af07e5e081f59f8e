"""Every part of a syntax tree, without recursion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

from sdfc.syntax import tree


@cache
def _parts(kind: Any) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind) if f.name not in ("span", "operator_span"))


def walk(root: object) -> Iterator[Any]:
    """The root and every node below it, in no particular order."""
    stack: list[object] = [root]
    while stack:
        node = stack.pop()
        if isinstance(node, tuple):
            stack.extend(node)
        elif is_dataclass(node):
            yield node
            kind: Any = type(node)
            stack.extend([getattr(node, name) for name in _parts(kind)])


def mentions(root: object) -> set[str]:
    """The names that are used as values or called, anywhere below the root."""
    names = {node.text for node in walk(root) if type(node) is tree.Name}
    return names | {node.name.text for node in walk(root) if type(node) is tree.Call}


def called(root: object) -> set[str]:
    """The names mentioned anywhere below the root, chained calls included."""
    return mentions(root) | {node.name.text for node in walk(root) if type(node) is tree.Method}
