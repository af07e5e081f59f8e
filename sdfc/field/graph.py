"""The field graph: interned expressions in a point. GLSL, float64, intervals and derivatives are all made from it.

Scalars and vectors mix as in GLSL: a FLOAT with a vector works component by component.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias, cast

from sdfc.field.folding import fold
from sdfc.field.operations import BINARY as BINARY
from sdfc.field.operations import COMPARISON as COMPARISON
from sdfc.field.operations import LEAVES as LEAVES
from sdfc.field.operations import LOGIC as LOGIC
from sdfc.field.operations import UNARY as UNARY
from sdfc.field.operations import Op as Op
from sdfc.field.operations import Type as Type
from sdfc.field.simplify import simplify

# members of enums are dear to look up, and nodes are made by the ten thousand
_CONST, _FLOAT = Op.CONST, Type.FLOAT
_OF_SIZE = tuple(Type)  # by the number of components
_RESULT = dict.fromkeys((Op.DOT, Op.LENGTH), Type.FLOAT) | dict.fromkeys(COMPARISON | LOGIC, Type.BOOL)

Value: TypeAlias = tuple[float, ...] | tuple[int, ...] | str | None
Number: TypeAlias = float | int
Operand: TypeAlias = "Expr | float | int"


@dataclass(frozen=True, slots=True, eq=False)
class Expr:
    """A node. Equal means identical: only `FieldGraph.add` makes nodes."""

    graph: FieldGraph = field(repr=False)
    id: int
    op: Op
    type: Type
    args: tuple[Expr, ...] = field(repr=False)
    value: Value

    def __add__(self, other: Operand) -> Expr:
        return self.graph.add(Op.ADD, self, self.graph.lift(other))

    def __radd__(self, other: Operand) -> Expr:
        return self.graph.add(Op.ADD, self.graph.lift(other), self)

    def __sub__(self, other: Operand) -> Expr:
        return self.graph.add(Op.SUB, self, self.graph.lift(other))

    def __rsub__(self, other: Operand) -> Expr:
        return self.graph.add(Op.SUB, self.graph.lift(other), self)

    def __mul__(self, other: Operand) -> Expr:
        return self.graph.add(Op.MUL, self, self.graph.lift(other))

    def __rmul__(self, other: Operand) -> Expr:
        return self.graph.add(Op.MUL, self.graph.lift(other), self)

    def __truediv__(self, other: Operand) -> Expr:
        return self.graph.add(Op.DIV, self, self.graph.lift(other))

    def __rtruediv__(self, other: Operand) -> Expr:
        return self.graph.add(Op.DIV, self.graph.lift(other), self)

    def __neg__(self) -> Expr:
        return self.graph.add(Op.NEG, self)

    def __lt__(self, other: Operand) -> Expr:
        return self.graph.add(Op.LESS, self, self.graph.lift(other))

    def __le__(self, other: Operand) -> Expr:
        return self.graph.add(Op.LESS_EQUAL, self, self.graph.lift(other))

    def __getitem__(self, index: int) -> Expr:
        return self.graph.swizzle(self, (index,))

    def swizzle(self, letters: str) -> Expr:
        return self.graph.swizzle(self, tuple("xyzw".index(c) for c in letters))

    @property
    def is_constant(self) -> bool:
        return self.op is _CONST

    @property
    def number(self) -> float:
        """The value of a constant FLOAT."""
        assert self.type is _FLOAT
        return self.numbers[0]

    @property
    def numbers(self) -> tuple[float, ...]:
        """The components of a constant."""
        assert self.op is _CONST
        return cast("tuple[float, ...]", self.value)


class FieldGraph:
    """All expressions of one compilation. Equal expressions are one node; constants fold in float64 as they come."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[object, ...], Expr] = {}

    def __len__(self) -> int:
        return len(self._nodes)

    def _intern(self, op: Op, type_: Type, args: tuple[Expr, ...], value: Value) -> Expr:
        # repr keeps -0.0 and 0.0 apart, and makes NaN equal to itself
        key = (op, type_, tuple([a.id for a in args]), repr(value) if op is _CONST else value)
        node = self._nodes.get(key)
        if node is None:
            node = self._nodes[key] = Expr(self, len(self._nodes), op, type_, args, value)
        return node

    def constant(self, *components: Number) -> Expr:
        return self._intern(_CONST, _OF_SIZE[len(components)], (), tuple(map(float, components)))

    def boolean(self, value: bool) -> Expr:
        return self._intern(_CONST, Type.BOOL, (), (float(value),))

    def lift(self, value: Operand) -> Expr:
        return value if isinstance(value, Expr) else self.constant(value)

    def input(self, name: str, type_: Type = Type.VEC3) -> Expr:
        return self._intern(Op.INPUT, type_, (), name)

    def param(self, name: str, type_: Type = Type.FLOAT) -> Expr:
        return self._intern(Op.PARAM, type_, (), name)

    def vector(self, *components: Operand) -> Expr:
        return self.add(Op.VECTOR, *(self.lift(c) for c in components))

    def swizzle(self, vector: Expr, indices: tuple[int, ...]) -> Expr:
        return self.add(Op.SWIZZLE, vector, value=indices)

    def add(self, op: Op, *args: Expr, value: Value = None) -> Expr:
        """The node for `op(args)`, folded or simplified where that is exact."""
        for argument in args:
            if argument.op is not _CONST:
                simple = simplify(self, op, args, value)
                return simple or self._intern(op, _result_type(op, args, value), args, value)
        type_ = _result_type(op, args, value)
        return self._intern(_CONST, type_, (), fold(op, [a.numbers for a in args], type_.size, value))

    # GLSL's vocabulary, for code that builds formulas

    def call(self, op: Op, *args: Operand) -> Expr:
        return self.add(op, *(self.lift(a) for a in args))

    def min(self, a: Operand, b: Operand) -> Expr:
        return self.call(Op.MIN, a, b)

    def max(self, a: Operand, b: Operand) -> Expr:
        return self.call(Op.MAX, a, b)

    def clamp(self, x: Operand, lo: Operand, hi: Operand) -> Expr:
        return self.min(self.max(x, lo), hi)

    def sqrt(self, x: Operand) -> Expr:
        return self.call(Op.SQRT, x)

    def abs(self, x: Operand) -> Expr:
        return self.call(Op.ABS, x)

    def length(self, x: Expr) -> Expr:
        return self.add(Op.LENGTH, x)

    def dot(self, a: Expr, b: Expr) -> Expr:
        return self.add(Op.DOT, a, b)

    def cross(self, a: Expr, b: Expr) -> Expr:
        return self.vector(
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        )

    def select(self, condition: Expr, then: Operand, otherwise: Operand) -> Expr:
        return self.add(Op.SELECT, condition, self.lift(then), self.lift(otherwise))


def _result_type(op: Op, args: Sequence[Expr], value: Value) -> Type:
    if op in _RESULT:
        return _RESULT[op]
    if op is Op.VECTOR:
        return _OF_SIZE[len(args)]
    if op is Op.SWIZZLE:
        assert isinstance(value, tuple)
        return _OF_SIZE[len(value)]
    last = args[-1].type
    first = args[-2].type if len(args) > 1 else last
    return first if first.size >= last.size else last


def arguments(node: Expr) -> Sequence[Expr]:
    """The arguments of a node: what `topological` follows unless told otherwise."""
    return node.args


def topological(roots: Iterable[Expr], below: Callable[[Expr], Sequence[Expr]] = arguments) -> Iterator[Expr]:
    """Every node below the roots, arguments before users, the first argument first, each once.

    Iterative: depth is no limit. `below` may leave arguments out or put them in another order.
    """
    done: set[int] = set()
    opened: set[int] = set()
    stack = list(roots)
    stack.reverse()
    while stack:
        node = stack[-1]
        number = node.id
        if number not in opened:
            opened.add(number)
            missing = [a for a in below(node) if a.id not in done]
            if missing:
                missing.reverse()
                stack += missing
                continue
        stack.pop()
        if number not in done:
            done.add(number)
            yield node


def substitute(root: Expr, replace: dict[Expr, Expr]) -> Expr:
    """`root` with each key (usually an INPUT) replaced by its value."""
    made: dict[int, Expr] = {key.id: value for key, value in replace.items()}
    for node in topological([root]):
        if node.id not in made:
            args = tuple(made[a.id] for a in node.args)
            unchanged = all(a is b for a, b in zip(args, node.args, strict=True))
            made[node.id] = node if unchanged else node.graph.add(node.op, *args, value=node.value)
    return made[root.id]


def inputs_of(root: Expr) -> frozenset[Expr]:
    """The INPUT nodes that `root` depends on."""
    return frozenset(n for n in topological([root]) if n.op is Op.INPUT)


def params_of(roots: Iterable[Expr]) -> frozenset[str]:
    """The names of the params that the roots depend on."""
    return frozenset(str(n.value) for n in topological(roots) if n.op is Op.PARAM)
