"""The syntax tree as text: an indented line a node, with its place."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from sdfc.diagnostics import Source, Span


def show(root: object) -> str:
    """Every node with those of its fields that are not nodes, and below it those that are."""
    lines: list[str] = []
    stack: list[tuple[str, Any, int]] = [("", root, 0)]
    while stack:
        label, node, depth = stack.pop()
        pad = "  " * min(depth, 60)  # a chain of thousands would be mostly blanks
        if isinstance(node, tuple):
            stack.extend((label, part, depth) for part in reversed(node))
        elif _is_node(node):
            values = {f.name: getattr(node, f.name) for f in fields(node)}
            own = [f"{n}={v!r}" for n, v in values.items() if not _is_tree(v) and not isinstance(v, Source | Span)]
            place = f"  // {values['span']}" if "span" in values else ""
            lines.append(f"{pad}{label}{' '.join([type(node).__name__, *own])}{place}")
            stack.extend((f"{n}: ", v, depth + 1) for n, v in reversed(values.items()) if _is_tree(v))
        else:
            lines.append(f"{pad}{label}{node!r}")
    return "\n".join(lines)


def _is_node(value: object) -> bool:
    return is_dataclass(value) and not isinstance(value, Source | Span | type)


def _is_tree(value: object) -> bool:
    return _is_node(value) or (isinstance(value, tuple) and any(map(_is_node, value)))
