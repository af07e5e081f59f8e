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


def same_zeros(root: Expr) -> Expr:
    """An expression below `root` that is positive, zero and negative where `root` is: no factor was taken away that is
    zero anywhere else."""
    while True:
        factors = [(a, b) for a, b in _factors(root) if is_positive(b) and _is_zero_only_with(b, a)]
        if not factors:
            return root
        root = factors[0][0]


def _factors(node: Expr) -> list[tuple[Expr, Expr]]:
    """The ways to see a node as something times (or divided by) something else, which is second."""
    match node.op:
        case Op.MUL:
            return [(node.args[0], node.args[1]), (node.args[1], node.args[0])]
        case Op.DIV:
            return [(node.args[0], node.args[1])]
        case _:
            return []


def _is_zero_only_with(root: Expr, base: Expr) -> bool:
    """Whether the FLOAT is by its form zero nowhere but where `base` is."""
    known: dict[int, bool] = {}
    for node in topological([root]):
        below = [known[a.id] for a in node.args]
        match node.op:
            case Op.CONST:
                known[node.id] = all(n != 0.0 for n in node.numbers)
            case Op.EXP:
                known[node.id] = True
            case Op.ABS | Op.NEG | Op.SQRT | Op.MUL:
                known[node.id] = all(below)
            case Op.ADD:  # of what is never below zero, one is enough
                known[node.id] = any(below) and all(is_positive(a) for a in node.args)
            case _:
                known[node.id] = False
        known[node.id] = known[node.id] or node is base
    return known[root.id]


def is_positive(root: Expr) -> bool:
    """Whether the FLOAT is never below 0 by its form."""
    known: dict[int, bool] = {}
    for node in topological([root]):
        below = [known[a.id] for a in node.args]
        if node.op is Op.CONST:
            known[node.id] = min(node.numbers) >= 0.0
        elif node.op in _POSITIVE or (node.op is Op.MUL and _is_square(node, known)):
            known[node.id] = True
        elif node.op is Op.MAX:
            known[node.id] = any(below)
        elif node.op is Op.SWIZZLE:
            known[node.id] = below[0]
        else:
            known[node.id] = node.op in _KEPT and all(below)
    return known[root.id]


def _is_square(product: Expr, known: dict[int, bool]) -> bool:
    """Whether every factor that may be negative is there an even number of times."""
    counts: dict[int, int] = {}
    factors = [product]
    while factors:
        node = factors.pop()
        if node.op is Op.MUL and not known.get(node.id, False):
            factors.extend(node.args)
        else:
            counts[node.id] = counts.get(node.id, 0) + 1
    return all(known[factor] or count % 2 == 0 for factor, count in counts.items())
