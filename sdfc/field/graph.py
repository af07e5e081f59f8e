"""The field graph: interned expressions in a point. GLSL, float64, intervals and derivatives are all made from it.

Scalars and vectors mix as in GLSL: a FLOAT with a vector works component by component.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Sequence
from struct import Struct
from typing import Any, Final, TypeAlias, TypeVar

from sdfc.field.folding import fold
from sdfc.field.operations import BINARY as BINARY
from sdfc.field.operations import COMPARISON as COMPARISON
from sdfc.field.operations import LEAVES as LEAVES
from sdfc.field.operations import LOGIC as LOGIC
from sdfc.field.operations import UNARY as UNARY
from sdfc.field.operations import Op as Op
from sdfc.field.operations import Type as Type
from sdfc.field.simplify import SIMPLIFY

# members of enums are dear to look up, and nodes are asked for by the ten thousand
_CONST, _FLOAT, _BOOL = Op.CONST, Type.FLOAT, Type.BOOL
_ADD, _SUB, _MUL, _DIV, _VECTOR, _SWIZZLE = Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.VECTOR, Op.SWIZZLE
_OF_SIZE = tuple(Type)  # by the number of components
_BITS = tuple([Struct(f"{size}d").pack for size in range(5)])
_RESULT = dict.fromkeys((Op.DOT, Op.LENGTH), Type.FLOAT) | dict.fromkeys(COMPARISON | LOGIC, Type.BOOL)

Value: TypeAlias = tuple[float, ...] | tuple[int, ...] | str | None
Number: TypeAlias = float | int
Operand: TypeAlias = "Expr | float | int"
T = TypeVar("T")


class Expr:
    """A node. Equal means identical: only `FieldGraph` makes nodes, and nothing changes them.

    No dataclass: a frozen one takes thrice as long to make. `numbers` are the components of a constant; no other node
    has any.
    """

    __slots__ = ("args", "graph", "id", "is_constant", "numbers", "op", "type", "value")

    def __init__(
        self, graph: FieldGraph, number: int, op: Op, type_: Type, args: tuple[Expr, ...], value: Value
    ) -> None:
        self.graph: Final = graph
        self.id: Final = number
        self.op: Final = op
        self.type: Final = type_
        self.args: Final = args
        self.value: Final = value
        self.is_constant: Final = op is _CONST
        if op is _CONST:
            assert isinstance(value, tuple)
            self.numbers: Final[tuple[float, ...]] = value

    def __repr__(self) -> str:
        return f"Expr(id={self.id!r}, op={self.op!r}, type={self.type!r}, value={self.value!r})"

    def __add__(self, other: Operand) -> Expr:
        return self.graph.add(_ADD, self, self.graph.lift(other))

    def __radd__(self, other: Operand) -> Expr:
        return self.graph.add(_ADD, self.graph.lift(other), self)

    def __sub__(self, other: Operand) -> Expr:
        return self.graph.add(_SUB, self, self.graph.lift(other))

    def __rsub__(self, other: Operand) -> Expr:
        return self.graph.add(_SUB, self.graph.lift(other), self)

    def __mul__(self, other: Operand) -> Expr:
        return self.graph.add(_MUL, self, self.graph.lift(other))

    def __rmul__(self, other: Operand) -> Expr:
        return self.graph.add(_MUL, self.graph.lift(other), self)

    def __truediv__(self, other: Operand) -> Expr:
        return self.graph.add(_DIV, self, self.graph.lift(other))

    def __rtruediv__(self, other: Operand) -> Expr:
        return self.graph.add(_DIV, self.graph.lift(other), self)

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
    def number(self) -> float:
        """The value of a constant FLOAT."""
        assert self.type is _FLOAT
        return self.numbers[0]


class FieldGraph:
    """All expressions of one compilation. Equal expressions are one node; constants fold in float64 as they come."""

    def __init__(self) -> None:
        self._count = 0
        self._constants: dict[tuple[Type, bytes], Expr] = {}
        self._leaves: dict[tuple[Op, Type, str], Expr] = {}
        # what was asked for, and what it was made to: a node of its own, or a simpler one
        self._made: dict[tuple[Op, tuple[Expr, ...], Value], Expr] = {}
        self._remembered: dict[Hashable, Any] = {}

    def remembered(self, question: Hashable, answer: Callable[[], T]) -> T:
        """What was found out about nodes of this graph, once for all who ask: the question says what, and of which."""
        if question not in self._remembered:
            self._remembered[question] = answer()
        found: T = self._remembered[question]
        return found

    def __len__(self) -> int:
        return self._count

    def _new(self, op: Op, type_: Type, args: tuple[Expr, ...], value: Value) -> Expr:
        node = Expr(self, self._count, op, type_, args, value)
        self._count += 1
        return node

    def _constant(self, type_: Type, numbers: tuple[Number, ...]) -> Expr:
        """Bit for bit, which keeps -0.0 and 0.0 apart; but every NaN is one."""
        key = type_, _BITS[len(numbers)](*numbers)
        node = self._constants.get(key)
        if node is None:
            numbers = tuple([math.nan if math.isnan(n) else float(n) for n in numbers])
            key = type_, _BITS[len(numbers)](*numbers)
            node = self._constants.get(key) or self._constants.setdefault(key, self._new(_CONST, type_, (), numbers))
        return node

    def _leaf(self, op: Op, type_: Type, name: str) -> Expr:
        key = op, type_, name
        return self._leaves.get(key) or self._leaves.setdefault(key, self._new(op, type_, (), name))

    def constant(self, *components: Number) -> Expr:
        return self._constant(_OF_SIZE[len(components)], components)

    def boolean(self, value: bool) -> Expr:
        return self._constant(_BOOL, (value,))

    def lift(self, value: Operand) -> Expr:
        return value if isinstance(value, Expr) else self.constant(value)

    def input(self, name: str, type_: Type = Type.VEC3) -> Expr:
        return self._leaf(Op.INPUT, type_, name)

    def param(self, name: str, type_: Type = Type.FLOAT) -> Expr:
        return self._leaf(Op.PARAM, type_, name)

    def vector(self, *components: Operand) -> Expr:
        return self.add(_VECTOR, *[self.lift(c) for c in components])

    def swizzle(self, vector: Expr, indices: tuple[int, ...]) -> Expr:
        return self.add(_SWIZZLE, vector, value=indices)

    def add(self, op: Op, *args: Expr, value: Value = None) -> Expr:
        """The node for `op(args)`, folded or simplified where that is exact."""
        key = op, args, value
        node = self._made.get(key)
        if node is None:
            node = self._made[key] = self._added(op, args, value)
        return node

    def _added(self, op: Op, args: tuple[Expr, ...], value: Value) -> Expr:
        for argument in args:
            if not argument.is_constant:
                rule = SIMPLIFY.get(op)
                simple = None if rule is None else rule(self, args, value)
                return simple or self._new(op, _result_type(op, args, value), args, value)
        type_ = _result_type(op, args, value)
        return self._constant(type_, fold(op, [a.numbers for a in args], type_.size, value))

    # GLSL's vocabulary, for code that builds formulas

    def call(self, op: Op, *args: Operand) -> Expr:
        return self.add(op, *[self.lift(a) for a in args])

    def min(self, a: Operand, b: Operand) -> Expr:
        return self.add(Op.MIN, self.lift(a), self.lift(b))

    def max(self, a: Operand, b: Operand) -> Expr:
        return self.add(Op.MAX, self.lift(a), self.lift(b))

    def clamp(self, x: Operand, lo: Operand, hi: Operand) -> Expr:
        return self.min(self.max(x, lo), hi)

    def sqrt(self, x: Operand) -> Expr:
        return self.add(Op.SQRT, self.lift(x))

    def abs(self, x: Operand) -> Expr:
        return self.add(Op.ABS, self.lift(x))

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
    if op is _VECTOR:
        return _OF_SIZE[len(args)]
    if op is _SWIZZLE:
        assert isinstance(value, tuple)
        return _OF_SIZE[len(value)]
    last = args[-1].type
    first = args[-2].type if len(args) > 1 else last
    return first if first.size >= last.size else last


def topological(roots: Iterable[Expr], below: Callable[[Expr], Sequence[Expr]] | None = None) -> list[Expr]:
    """Every node below the roots, arguments before users, the first argument first, each once.

    Iterative: depth is no limit. `below` may leave arguments out or put them in another order.
    """
    order: list[Expr] = []
    done: set[Expr] = set()
    stack = list(roots)
    stack.reverse()
    while stack:
        node = stack.pop()
        if node in done:
            continue
        args = node.args if below is None else below(node)
        if done.issuperset(args):
            done.add(node)
            order.append(node)
        else:
            stack.append(node)  # again, when what is missing is there
            stack += args[::-1]
    return order


def substitute(root: Expr, replace: dict[Expr, Expr]) -> Expr:
    """`root` with each key (usually an INPUT) replaced by its value."""
    made: dict[int, Expr] = {key.id: value for key, value in replace.items()}
    for node in topological([root]):
        if node.id not in made:
            args = tuple([made[a.id] for a in node.args])
            made[node.id] = node if args == node.args else node.graph.add(node.op, *args, value=node.value)
    return made[root.id]


def inputs_of(root: Expr) -> frozenset[Expr]:
    """The INPUT nodes that `root` depends on."""
    return frozenset([n for n in topological([root]) if n.op is Op.INPUT])


def params_of(roots: Iterable[Expr]) -> frozenset[str]:
    """The names of the params that the roots depend on."""
    return frozenset([str(n.value) for n in topological(roots) if n.op is Op.PARAM])
