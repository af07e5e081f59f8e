"""The NumPy interpretation of the field graph: the reference that every other one is held against."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from sdfc.field.graph import LEAVES, Expr, Op, Type
from sdfc.field.order import evaluation_order

Array: TypeAlias = npt.NDArray[Any]
Real: TypeAlias = type[np.floating[Any]]

# Points per block. The temporaries of a block stay in the cache (a vec3 of float64 is 384 KiB) and calls cost little.
BLOCK = 16384


@dataclass(frozen=True, slots=True)
class _Step:
    """registers[target] = function(*registers of the arguments)."""

    function: Callable[..., Any]
    target: int
    args: tuple[int, ...]


class Evaluator:
    """Evaluates expressions over arrays of points; prepared once, called often.

    A FLOAT is an array of shape (n,), a VECk of shape (k, n), a BOOL (n,) of bool. What depends on no input has shape
    () or (k, 1). `dtype` is the precision of every operation (float32 shows what a GPU's rounding does).
    """

    def __init__(self, roots: Sequence[Expr], dtype: Real = np.float64) -> None:
        self._dtype = dtype
        self._roots = tuple(roots)
        order = evaluation_order(roots)
        self._varying = _depending_on_inputs(order)
        registers, self._count = _registers(order, self._varying, self._roots)
        self._results = tuple(registers[root.id] for root in roots)
        self._leaves = {leaf: registers[leaf.id] for leaf in order if leaf.op in LEAVES}
        steps = [(node, _step(node, registers, dtype)) for node in order if node.op not in LEAVES]
        self._once = [step for node, step in steps if node.id not in self._varying]
        self._per_block = [step for node, step in steps if node.id in self._varying]

    def __call__(
        self, inputs: Mapping[str, npt.ArrayLike], params: Mapping[str, npt.ArrayLike] | None = None
    ) -> list[Array]:
        """The value of each root.

        An input is (n,) or (k, n); one value for all points is () or (k, 1). A param is a number or k numbers.
        """
        registers: list[Any] = [None] * self._count
        arrays = {}
        for leaf, register in self._leaves.items():
            if leaf.op is Op.INPUT:
                arrays[register] = _input(leaf, inputs, self._dtype)
            else:
                registers[register] = _given(leaf, params or {}, self._dtype)
        points = max((a.shape[-1] for a in arrays.values()), key=lambda n: -1 if n == 1 else n, default=1)
        arrays = {register: np.broadcast_to(a, (*a.shape[:-1], points)) for register, a in arrays.items()}
        with np.errstate(all="ignore"):
            _run(self._once, registers)
            return self._blocks(registers, arrays, points)

    def _blocks(self, registers: list[Any], arrays: Mapping[int, Array], points: int) -> list[Array]:
        results = [self._empty(root, points) for root in self._roots]
        for start in range(0, max(points, 1), BLOCK):
            for register, array in arrays.items():
                registers[register] = array[..., start : start + BLOCK]
            _run(self._per_block, registers)
            for result, root, register in zip(results, self._roots, self._results, strict=True):
                if root.id in self._varying:
                    result[..., start : start + BLOCK] = registers[register]
                elif start == 0:
                    result[...] = np.reshape(registers[register], result.shape)
        return results

    def _empty(self, root: Expr, points: int) -> Array:
        columns = points if root.id in self._varying else 1
        match root.type:
            case Type.BOOL | Type.FLOAT:
                shape: tuple[int, ...] = (columns,) if root.id in self._varying else ()
            case Type.VEC2 | Type.VEC3 | Type.VEC4:
                shape = (root.type.size, columns)
        return np.empty(shape, bool if root.type is Type.BOOL else self._dtype)


def _depending_on_inputs(order: Sequence[Expr]) -> frozenset[int]:
    varying: set[int] = set()
    for node in order:
        if node.op is Op.INPUT or any(a.id in varying for a in node.args):
            varying.add(node.id)
    return frozenset(varying)


def _registers(order: Sequence[Expr], varying: frozenset[int], roots: Sequence[Expr]) -> tuple[dict[int, int], int]:
    """A register for each node, and their number. What varies gives its register back after its last use."""
    last_user = {a.id: node.id for node in order for a in node.args}
    kept = {root.id for root in roots} | {node.id for node in order if node.op in LEAVES or node.id not in varying}
    registers: dict[int, int] = {}
    free: list[int] = []
    count = 0
    for node in order:
        ended = {a.id for a in node.args if last_user[a.id] == node.id} - kept
        free.extend(registers[a] for a in sorted(ended))
        if free and node.id not in kept:
            registers[node.id] = free.pop()
        else:
            registers[node.id] = count
            count += 1
    return registers, count


def _run(steps: Sequence[_Step], registers: list[Any]) -> None:
    for step in steps:
        registers[step.target] = step.function(*[registers[a] for a in step.args])


def _input(leaf: Expr, inputs: Mapping[str, npt.ArrayLike], dtype: Real) -> Array:
    array = np.asarray(inputs[str(leaf.value)], bool if leaf.type is Type.BOOL else dtype)
    if leaf.type.value <= 1:
        return array.reshape(1) if array.ndim == 0 else array
    assert array.shape[0] == leaf.type.size, f"input {leaf.value}: {array.shape} is not ({leaf.type.size}, n)"
    return array.reshape(-1, 1) if array.ndim == 1 else array


def _given(leaf: Expr, params: Mapping[str, npt.ArrayLike], dtype: Real) -> Any:
    """The value of a constant or a param: a scalar, or (k, 1)."""
    numbers = leaf.numbers if leaf.op is Op.CONST else np.ravel(params[str(leaf.value)])
    if leaf.type is Type.BOOL:
        return np.bool_(numbers[0])
    return dtype(numbers[0]) if leaf.type is Type.FLOAT else np.asarray(numbers, dtype).reshape(-1, 1)


def _step(node: Expr, registers: Mapping[int, int], dtype: Real) -> _Step:
    return _Step(_function(node, dtype), registers[node.id], tuple(registers[a.id] for a in node.args))


def _function(node: Expr, dtype: Real) -> Callable[..., Any]:
    """What computes a node. The three that need more than the values of the arguments are made here."""
    vector = node.args[0].type.size > 1
    match node.op:
        case Op.VECTOR:
            return lambda *components: _stack(components, dtype)
        case Op.SWIZZLE:
            assert isinstance(node.value, tuple)
            picked: Any = [int(i) for i in node.value] if len(node.value) > 1 else int(node.value[0])
            if vector:
                return lambda v: v[picked]
            return lambda v: _stack([v] * node.type.size, dtype)
        case Op.LENGTH:
            return _length if vector else np.abs
        case Op.DOT:
            return _dot if vector else np.multiply
        case _:
            return FUNCTIONS[node.op]


def _stack(components: Sequence[Any], dtype: Real) -> Array:
    columns = max((c.shape[-1] for c in components if c.ndim), default=1)
    result = np.empty((len(components), columns), dtype)
    for row, component in zip(result, components, strict=True):
        row[...] = component
    return result


def _dot(a: Array, b: Array) -> Array:
    total: Array = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def _length(v: Array) -> Array:
    length: Array = np.sqrt(_dot(v, v))
    return length


# The operations that work component by component, whatever the shapes (constants have the evaluator's dtype).
FUNCTIONS: dict[Op, Callable[..., Any]] = {
    Op.NEG: np.negative,
    Op.ABS: np.abs,
    Op.SIGN: np.sign,
    Op.FLOOR: np.floor,
    Op.ROUND: lambda x: np.floor(x + x.dtype.type(0.5)),
    Op.SQRT: np.sqrt,
    Op.SIN: np.sin,
    Op.COS: np.cos,
    Op.TAN: np.tan,
    Op.ASIN: np.arcsin,
    Op.ACOS: np.arccos,
    Op.ATAN: np.arctan,
    Op.EXP: np.exp,
    Op.LOG: np.log,
    Op.ADD: np.add,
    Op.SUB: np.subtract,
    Op.MUL: np.multiply,
    Op.DIV: np.divide,
    Op.MIN: np.minimum,
    Op.MAX: np.maximum,
    Op.MOD: lambda a, b: a - b * np.floor(a / b),
    Op.POW: np.power,
    Op.ATAN2: np.arctan2,
    Op.LESS: np.less,
    Op.LESS_EQUAL: np.less_equal,
    Op.EQUAL: np.equal,
    Op.AND: np.logical_and,
    Op.OR: np.logical_or,
    Op.NOT: np.logical_not,
    Op.SELECT: np.where,
}
