"""Rewrites to equal, simpler nodes, tried as each node is added."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from sdfc.field.operations import Op, Type

if TYPE_CHECKING:
    from sdfc.field.graph import Expr, FieldGraph


Arguments: TypeAlias = "tuple[Expr, ...]"
Rule: TypeAlias = "Callable[[FieldGraph, Arguments, object], Expr | None]"

_IN_ORDER = tuple(tuple(range(size)) for size in range(5))
_NEG, _SWIZZLE, _VECTOR, _BOOL = Op.NEG, Op.SWIZZLE, Op.VECTOR, Type.BOOL  # looked up once: this is asked often


def _is_zero(constant: Expr) -> bool:
    return not any(constant.numbers)


def _is_all(constant: Expr, value: float) -> bool:
    return constant.type is not _BOOL and constant.numbers.count(value) == len(constant.numbers)


def _zeros(graph: FieldGraph, *like: Expr) -> Expr:
    return graph.constant(*([0.0] * max([e.type.size for e in like])))


def _simplify_add(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if b.is_constant and _is_zero(b) and a.type.size >= b.type.size:
        return a
    if a.is_constant and _is_zero(a) and b.type.size >= a.type.size:
        return b
    return graph.add(Op.SUB, a, b.args[0]) if b.op is _NEG else None


def _simplify_sub(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if b.is_constant and _is_zero(b) and a.type.size >= b.type.size:
        return a
    if a.is_constant and _is_zero(a) and b.type.size >= a.type.size:
        return graph.add(Op.NEG, b)
    if a is b:
        return _zeros(graph, a)
    return graph.add(Op.ADD, a, b.args[0]) if b.op is _NEG else None


def _simplify_mul(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if not (a.is_constant or b.is_constant):
        return None
    factor, other = (b, a) if b.is_constant else (a, b)  # one of them is none, or it would be folded
    if _is_zero(factor):
        return _zeros(graph, a, b)
    if other.type.size < factor.type.size:
        return None
    if _is_all(factor, 1.0):
        return other
    return graph.add(_NEG, other) if _is_all(factor, -1.0) else None


def _simplify_div(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if a.is_constant and _is_zero(a):
        return _zeros(graph, a, b)
    if b.is_constant and a.type.size >= b.type.size and _is_all(b, 1.0):
        return a
    return graph.add(Op.NEG, a) if b.is_constant and a.type.size >= b.type.size and _is_all(b, -1.0) else None


def _simplify_pow(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    return a if b.is_constant and a.type.size >= b.type.size and _is_all(b, 1.0) else None


def _simplify_neg(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    (a,) = args
    return a.args[0] if a.op is Op.NEG else None


def _simplify_abs(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    (a,) = args
    return a if a.op is Op.ABS else graph.add(Op.ABS, a.args[0]) if a.op is Op.NEG else None


def _simplify_same(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    return a if a is b else None


def _simplify_and(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if a.is_constant:
        return b if a.numbers[0] else a
    if b.is_constant:
        return a if b.numbers[0] else b
    return a if a is b else None


def _simplify_or(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    a, b = args
    if a.is_constant:
        return a if a.numbers[0] else b
    if b.is_constant:
        return b if b.numbers[0] else a
    return a if a is b else None


def _simplify_not(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    (a,) = args
    return a.args[0] if a.op is Op.NOT else None


def _simplify_select(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    condition, a, b = args
    if a is b:
        return a
    if not condition.is_constant:
        return None
    chosen, other = (a, b) if condition.numbers[0] else (b, a)
    if chosen.type.size >= other.type.size:
        return chosen
    return graph.add(Op.VECTOR, *([chosen] * other.type.size))


def _simplify_swizzle(graph: FieldGraph, args: Arguments, indices: object) -> Expr | None:
    (a,) = args
    assert isinstance(indices, tuple)
    if indices == _IN_ORDER[a.type.size]:
        return a
    if a.op is _VECTOR:
        picked = [a.args[i] for i in indices]
        return picked[0] if len(picked) == 1 else graph.add(Op.VECTOR, *picked)
    if a.op is _SWIZZLE:
        assert isinstance(a.value, tuple)
        return graph.swizzle(a.args[0], tuple(int(a.value[i]) for i in indices))
    return None


def _simplify_vector(graph: FieldGraph, args: Arguments, value: object) -> Expr | None:
    """vec3(v.x, v.y, v.z) is v."""
    whole = args[0].args[0] if args[0].op is _SWIZZLE else None
    if whole is None or whole.type.size != len(args):
        return None
    in_order = all(a.op is _SWIZZLE and a.args[0] is whole and a.value == (i,) for i, a in enumerate(args))
    return whole if in_order else None


# An equal, simpler node, or None. Only rewrites that are exact in real arithmetic for finite values.
SIMPLIFY: dict[Op, Rule] = {
    Op.ADD: _simplify_add,
    Op.SUB: _simplify_sub,
    Op.MUL: _simplify_mul,
    Op.DIV: _simplify_div,
    Op.POW: _simplify_pow,
    Op.NEG: _simplify_neg,
    Op.ABS: _simplify_abs,
    Op.MIN: _simplify_same,
    Op.MAX: _simplify_same,
    Op.AND: _simplify_and,
    Op.OR: _simplify_or,
    Op.NOT: _simplify_not,
    Op.SELECT: _simplify_select,
    Op.SWIZZLE: _simplify_swizzle,
    Op.VECTOR: _simplify_vector,
}
