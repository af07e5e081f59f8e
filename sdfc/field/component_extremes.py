"""Which scalar extremes are of the components of one vector: max(q.x, max(q.y, q.z)), or max(a, b) beside vec2(a, b).

The derivative of such a one is a unit vector, which one choice finds (sdfc/field/derivative).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.field.graph import Expr
from sdfc.field.operations import Op, Type

_MOST = 3  # operands; a point has no more components, and so a chain of a thousand costs no more than its length


@dataclass(frozen=True, slots=True)
class Components:
    """An extremum of components of `vector`: its operands in the order of the expression, and which each is."""

    vector: Expr
    operands: tuple[Expr, ...]
    indices: tuple[int, ...]


def component_extremes(order: Sequence[Expr]) -> dict[int, Components]:
    """By its id, each scalar min or max in the order (arguments come first) that is of components of one vector."""
    operands: dict[int, tuple[Expr, ...]] = {}
    vectors: dict[frozenset[int], Expr] = {}
    for node in order:
        if node.op is Op.VECTOR:
            vectors.setdefault(frozenset([a.id for a in node.args]), node)
        elif (node.op is Op.MIN or node.op is Op.MAX) and node.type is Type.FLOAT:
            found = tuple([e for a in node.args for e in (operands.get(a.id, (a,)) if a.op is node.op else (a,))])
            if len(found) <= _MOST:
                operands[node.id] = found
    extremes = {number: _components(found, vectors) for number, found in operands.items()}
    return {number: components for number, components in extremes.items() if components is not None}


def _components(operands: tuple[Expr, ...], vectors: dict[frozenset[int], Expr]) -> Components | None:
    """The vector that has the operands, all of them different and none a number, as components."""
    made = vectors.get(frozenset([e.id for e in operands]))
    if made is not None and len(made.args) == len(operands) and not any(e.is_constant for e in operands):
        return Components(made, operands, tuple([made.args.index(e) for e in operands]))
    if not all(e.op is Op.SWIZZLE and e.args[0] is operands[0].args[0] for e in operands):
        return None
    vector = operands[0].args[0]
    indices = [e.value[0] for e in operands if isinstance(e.value, tuple)]
    return Components(vector, operands, tuple(map(int, indices))) if len(set(indices)) == len(operands) else None
