"""What a formula costs: its operations, weighted by what they take on processors of today, in additions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from sdfc.field.graph import Expr, Op
from sdfc.field.order import evaluation_order

_FREE = frozenset({Op.CONST, Op.INPUT, Op.PARAM, Op.VECTOR, Op.SWIZZLE})
_WEIGHTS: Mapping[Op, float] = MappingProxyType(
    dict.fromkeys((Op.SQRT, Op.DIV, Op.MOD), 4.0)
    | dict.fromkeys((Op.SIN, Op.COS, Op.EXP, Op.LOG), 12.0)
    | dict.fromkeys((Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN, Op.ATAN2, Op.POW), 24.0)
)


def cost(roots: Iterable[Expr]) -> float:
    """The cost of computing `roots` together, each shared expression once. Twice the cost is about twice the time."""
    return sum(_cost(node) for node in evaluation_order(roots))


def _cost(node: Expr) -> float:
    if node.op in _FREE:
        return 0.0
    if node.op in (Op.DOT, Op.LENGTH):
        size = node.args[0].type.size
        return 2.0 * size - 1.0 + (_WEIGHTS[Op.SQRT] if node.op is Op.LENGTH else 0.0)
    return _WEIGHTS.get(node.op, 1.0) * node.type.size
