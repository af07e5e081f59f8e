"""The syntax tree as text: an indented line a node, with its place."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from sdfc.diagnostics import Span


def show(root: object) -> str:
    """Every node with the fields that are not nodes, and below it those that are."""
    lines: list[str] = []
    stack: list[tuple[str, Any, int]] = [("", root, 0)]
    while stack:
        label, node, depth = stack.pop()
        pad = "  " * min(depth, 60)  # a chain of thousands would be mostly blanks
        if isinstance(node, tuple):
            stack.extend((label, part, depth) for part in reversed(node))
        elif hasattr(node, "span"):
            plain = {f.name: getattr(node, f.name) for f in fields(node) if not isinstance(getattr(node, f.name), Span)}
            own = [f"{name}={value!r}" for name, value in plain.items() if not _is_tree(value)]
            lines.append(f"{pad}{label}{' '.join([type(node).__name__, *own])}  // {node.span}")
            below = [(f"{name}: ", value, depth + 1) for name, value in plain.items() if _is_tree(value)]
            stack.extend(reversed(below))
        else:
            lines.append(f"{pad}{label}{node!r}")
    return "\n".join(lines)


def _is_tree(value: object) -> bool:
    return hasattr(value, "span") or (isinstance(value, tuple) and any(hasattr(v, "span") for v in value))
