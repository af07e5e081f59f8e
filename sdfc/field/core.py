"""What decides the sign of a field: without the positive factors around it, which only make a distance of it."""

from __future__ import annotations

from sdfc.field.graph import Expr, Op, topological

DEEP = 2.0**-16  # bounds of its bend hold so deep inside too, in its own unit: what is cut is looked for a little sunk

_POSITIVE = frozenset({Op.ABS, Op.SQRT, Op.LENGTH, Op.EXP})
_KEPT = frozenset({Op.ADD, Op.MUL, Op.DIV, Op.MIN})


def signed_core(root: Expr) -> Expr:
    """An expression below `root` that is positive and negative where `root` is, and as smooth or smoother."""
    while True:
        factor = _without_factor(root)
        if factor is None:
            return root
        root = factor


def _without_factor(node: Expr) -> Expr | None:
    if node.op not in (Op.MUL, Op.DIV):
        return None
    first, second = node.args
    if is_positive(second):
        return first
    return second if node.op is Op.MUL and is_positive(first) else None


def is_positive(root: Expr) -> bool:
    """Whether the FLOAT is never below 0 by its form."""
    known: dict[int, bool] = {}
    for node in topological([root]):
        below = [known[a.id] for a in node.args]
        if node.op is Op.CONST:
            known[node.id] = min(node.numbers) >= 0.0
        elif node.op in _POSITIVE or (node.op is Op.MUL and node.args[0] is node.args[1]):
            known[node.id] = True
        elif node.op is Op.MAX:
            known[node.id] = any(below)
        elif node.op is Op.SWIZZLE:
            known[node.id] = below[0]
        else:
            known[node.id] = node.op in _KEPT and all(below)
    return known[root.id]
