"""The field graph as text, for people: one line a node, or a short expression in a line."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from sdfc.field.graph import Expr, Op, topological

_INFIX = {Op.ADD: "+", Op.SUB: "-", Op.MUL: "*", Op.DIV: "/", Op.LESS: "<", Op.LESS_EQUAL: "<=", Op.EQUAL: "=="}
_LONGEST = 120  # characters of an expression in a line


def show(roots: Iterable[Expr]) -> str:
    """Every node below the roots once, arguments first: `%7 float = min(%3, 0)`. Leaves stand in place."""
    wanted = tuple(roots)
    lines = []
    for node in topological(wanted):
        if node.args or node in wanted:
            lines.append(f"%{node.id} {node.type.name.lower()} = {_text(node, _reference)}")
    return "\n".join(lines)


def inline(root: Expr) -> str:
    """The expression in one line, cut where it is long."""
    texts: dict[int, str] = {}
    for node in topological([root]):
        text = _text(node, lambda e: texts[e.id])
        texts[node.id] = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
    text = texts[root.id]
    return text[1:-1] if root.op in _INFIX and text.endswith(")") else text


def _reference(node: Expr) -> str:
    return f"%{node.id}" if node.args else _text(node, _reference)


def _text(node: Expr, text_of: Callable[[Expr], str]) -> str:
    args = [text_of(a) for a in node.args]
    match node.op:
        case Op.CONST:
            numbers = [str(v).lower() if isinstance(v, bool) else f"{v:.9g}" for v in _values(node)]
            return numbers[0] if len(numbers) == 1 else f"[{', '.join(numbers)}]"
        case Op.INPUT | Op.PARAM:
            return str(node.value)
        case Op.VECTOR:
            return f"[{', '.join(args)}]"
        case Op.SWIZZLE:
            return f"{args[0]}.{''.join('xyzw'[int(i)] for i in _values(node))}"
        case Op.NEG:
            return f"-{args[0]}"
        case op if op in _INFIX:
            return f"({args[0]} {_INFIX[op]} {args[1]})"
        case op:
            return f"{op.value}({', '.join(args)})"


def _values(node: Expr) -> tuple[float, ...]:
    return node.value if isinstance(node.value, tuple) else ()
