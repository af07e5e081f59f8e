"""Numbers that are the components of one vector, and used besides, get one local: the vector."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

from sdfc.field.graph import LEAVES, Expr, Op

_PLAIN = LEAVES | {Op.SWIZZLE, Op.NEG}  # the text of it is as good as a local


def gathered(order: Sequence[Expr], uses: Mapping[Expr, int], called: Container[Expr]) -> dict[Expr, Expr | None]:
    """The nodes whose local a vector is: for the last component in the order that vector, else None.

    Each component is used more than once, and none before the last of them is there. None is `called` something.
    """
    vectors = [n for n in order if n.op is Op.VECTOR and uses[n] and _is_of_locals(n, uses)]
    vectors = [v for v in vectors if not any(a in called for a in v.args)]
    if not vectors:
        return {}
    position = {node: i for i, node in enumerate(order)}
    first_use: dict[Expr, int] = {}
    for i, node in enumerate(order):
        for argument in node.args:
            first_use.setdefault(argument, i)
    found: dict[Expr, Expr | None] = {}
    for vector in vectors:
        last = max(vector.args, key=lambda a: position[a])
        is_in_time = all(position[last] < first_use[a] for a in vector.args)
        if is_in_time and not any(a in found for a in vector.args):
            found |= {a: vector if a is last else None for a in vector.args}
    return found


def _is_of_locals(vector: Expr, uses: Mapping[Expr, int]) -> bool:
    components = vector.args
    alone = len({a.id for a in components}) == len(components)
    return alone and all(a.op not in _PLAIN and uses.get(a, 0) > 1 for a in components)
