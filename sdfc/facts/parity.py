"""Which mirror planes a primitive has by the form of its formula: it may be looked at from either side of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from sdfc.field.graph import Expr, FieldGraph, Op, Type, topological
from sdfc.shape.definition import Argument, Definition, Kind

Parity: TypeAlias = int | None
"""Of a number where one coordinate changes its sign: 1, it stays; -1, it changes its sign too; None, not known."""

_ODD = frozenset({Op.NEG, Op.SIGN, Op.SIN, Op.TAN, Op.ASIN, Op.ATAN})
_EVEN = frozenset({Op.ABS, Op.COS})


def even_axes(definition: Definition, arguments: Sequence[Argument], values: FieldGraph) -> tuple[bool, ...]:
    """For each axis of its space, whether the formula has the same value, to the last bit, at a point and at its image
    beyond the plane across that axis: whatever the values of its arguments."""
    point = values.input("p", Type(definition.dimension))
    environment: dict[str, Argument] = {}
    for parameter, argument in zip(definition.values, arguments, strict=True):
        if not isinstance(argument, Expr) or parameter.kind is Kind.COUNT:
            return (False,) * definition.dimension  # they are part of the formula
        environment[parameter.name] = values.input(parameter.name, argument.type)
    nodes = list(topological([definition.formula(point, environment, {})]))
    return tuple([_parity(nodes, point, axis) == 1 for axis in range(definition.dimension)])


def _parity(nodes: Sequence[Expr], point: Expr, axis: int) -> Parity:
    """Of the last node, a number."""
    found: dict[int, tuple[Parity, ...]] = {}
    found[point.id] = tuple([-1 if i == axis else 1 for i in range(point.type.size)])
    # what has no row stays as it is
    for node in nodes:
        if [a for a in node.args if a.id in found]:
            parities = _of(node, [found.get(a.id) or (1,) * a.type.size for a in node.args])
            if parities.count(1) < len(parities):
                found[node.id] = parities
    return found.get(nodes[-1].id, (1,))[0]


def _of(node: Expr, below: Sequence[tuple[Parity, ...]]) -> tuple[Parity, ...]:
    """Of each component, by those of its arguments."""
    size = node.type.size
    match node.op:
        case Op.VECTOR:
            return tuple([parities[0] for parities in below])
        case Op.SWIZZLE:
            assert isinstance(node.value, tuple)
            return tuple([below[0][int(i)] for i in node.value])
        case Op.LENGTH:
            return (None if None in below[0] else 1,)
        case Op.DOT:
            products = {_product(a, b) for a, b in zip(*below, strict=True)}
            return (products.pop() if len(products) == 1 else None,)
        case _:
            rows = [parities if len(parities) == size else parities * size for parities in below]
            return tuple([_of_numbers(node.op, column) for column in zip(*rows, strict=True)])


def _of_numbers(op: Op, below: tuple[Parity, ...]) -> Parity:
    """Of an operation on numbers."""
    if op in _ODD:
        return below[0]
    if op in _EVEN:
        return None if below[0] is None else 1
    match op:
        case Op.ADD | Op.SUB:
            return below[0] if below[0] == below[1] else None
        case Op.MUL | Op.DIV:
            return _product(*below)
        case Op.SELECT:
            return below[1] if below[0] == 1 and below[1] == below[2] else None
        case _:
            return 1 if all(parity == 1 for parity in below) else None


def _product(a: Parity, b: Parity) -> Parity:
    return None if a is None or b is None else a * b
