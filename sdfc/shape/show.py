"""The shape graph as text: one line a node, children first, each once however often it is used."""

from __future__ import annotations

from typing import assert_never

from sdfc.field.show import inline
from sdfc.shape.definition import Argument
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Nothing,
    Paint,
    Shape,
    Union,
    topological,
)
from sdfc.shape.matrix import Matrix


def show(root: Shape) -> str:
    """`%3 = union(%1, %2)  // s.sdf:4:1`, a line for every node below the root."""
    numbers: dict[int, int] = {}
    lines = []
    for node in topological(root):
        numbers[node.id] = len(numbers) + 1
        lines.append(f"%{numbers[node.id]} = {_text(node, numbers)}  // {node.span}")
    return "\n".join(lines)


def _text(node: Shape, numbers: dict[int, int]) -> str:
    match node:
        case Apply():
            children = [f"%{numbers[c.id]}" for c in node.children]
            values = [f"{name}: {_argument(value)}" for name, value in node.environment.items()]
            return f"{node.definition.name}({', '.join(children + values)})"
        case Affine():
            return f"affine(%{numbers[node.child.id]}, {_matrix(node.forward)})"
        case Union():
            return f"union({', '.join(f'%{numbers[c.id]}' for c in node.children)})"
        case Intersection():
            return f"intersection({', '.join(f'%{numbers[c.id]}' for c in node.children)})"
        case Complement():
            return f"complement(%{numbers[node.child.id]})"
        case Paint():
            return f"paint(%{numbers[node.child.id]}, {node.material.name})"
        case Nothing():
            return "nothing"
    assert_never(node)


def _argument(value: Argument) -> str:
    return f"[{', '.join(map(inline, value))}]" if isinstance(value, tuple) else inline(value)


def _matrix(matrix: Matrix) -> str:
    rows = [f"[{', '.join(map(inline, row))}]" for row in matrix.linear]
    return f"linear: [{', '.join(rows)}], offset: [{', '.join(map(inline, matrix.offset))}]"
