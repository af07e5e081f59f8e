"""Which names a syntax tree uses and which it brings itself, found without recursion."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from sdfc.syntax import tree

_PLACES = ("span", "operator_span")  # what a node has beside its parts
_NAMES_AND_NUMBERS = ("str", "float", "Identifier", "Identifier | None")
_parts: dict[Any, tuple[str, ...]] = {}


@dataclass(frozen=True, slots=True)
class Mentions:
    """`used`: names of values, calls and chained calls; `bound`: variables of loops."""

    used: frozenset[str]
    bound: frozenset[str]


def mentions(root: object) -> Mentions:
    """The names anywhere below the root (a node, or a tuple of nodes)."""
    used: set[str] = set()
    bound: set[str] = set()
    stack: list[Any] = [root]
    while stack:
        node = stack.pop()
        kind = type(node)
        if kind is tuple:
            stack += node
            continue
        parts = _parts.get(kind)
        if parts is None:
            parts = _parts[kind] = _parts_of(kind)
        if kind is tree.Name:
            used.add(node.text)
        elif kind is tree.Call or kind is tree.Method:
            used.add(node.name.text)
        elif kind is tree.Loop:
            bound.add(node.variable.text)
        for part in parts:
            stack.append(getattr(node, part))
    return Mentions(frozenset(used), frozenset(bound))


def _parts_of(kind: Any) -> tuple[str, ...]:
    """The attributes of a node that hold nodes; of anything else, none."""
    if not is_dataclass(kind):
        return ()
    return tuple(f.name for f in fields(kind) if f.name not in _PLACES and f.type not in _NAMES_AND_NUMBERS)
