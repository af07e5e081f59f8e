"""The field graph: interned expressions in a point. GLSL, float64, intervals and derivatives are all made from it.

Scalars and vectors mix as in GLSL: a FLOAT with a vector works component by component.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias


class Type(Enum):
    """The type of an expression; the value is its number of components (0 for a boolean)."""

    BOOL = 0
    FLOAT = 1
    VEC2 = 2
    VEC3 = 3
    VEC4 = 4

    @property
    def size(self) -> int:
        return max(1, self.value)


class Op(Enum):
    """Every operation of the field graph. Each interpretation has a row for every one of them (tested)."""

    # leaves; Expr.value says which
    CONST = "const"  # value: tuple of floats, or (True,)/(False,) for a boolean
    INPUT = "input"  # value: a name: p (the point), o and d (a ray), a function's parameter, ...
    PARAM = "param"  # value: the name of a live `param` of the scene (a uniform)
    # vectors
    VECTOR = "vector"  # args: 2 to 4 scalars
    SWIZZLE = "swizzle"  # value: tuple of 1 to 4 indices
    DOT = "dot"
    LENGTH = "length"
    # component by component
    NEG = "neg"
    ABS = "abs"
    SIGN = "sign"
    FLOOR = "floor"
    ROUND = "round"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    TAN = "tan"
    ASIN = "asin"
    ACOS = "acos"
    ATAN = "atan"
    EXP = "exp"
    LOG = "log"
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    MIN = "min"
    MAX = "max"
    MOD = "mod"  # a - b * floor(a / b), as in GLSL
    POW = "pow"
    ATAN2 = "atan2"  # atan2(y, x)
    # booleans (scalars only)
    LESS = "less"
    LESS_EQUAL = "less_equal"
    EQUAL = "equal"
    AND = "and"
    OR = "or"
    NOT = "not"
    SELECT = "select"  # select(condition, then, else)


UNARY = frozenset(
    {Op.NEG, Op.ABS, Op.SIGN, Op.FLOOR, Op.ROUND, Op.SQRT, Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN}
    | {Op.EXP, Op.LOG}
)
BINARY = frozenset({Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX, Op.MOD, Op.POW, Op.ATAN2})
COMPARISON = frozenset({Op.LESS, Op.LESS_EQUAL, Op.EQUAL})
LOGIC = frozenset({Op.AND, Op.OR, Op.NOT})
LEAVES = frozenset({Op.CONST, Op.INPUT, Op.PARAM})

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
        return self.op is Op.CONST

    @property
    def number(self) -> float:
        """The value of a constant FLOAT."""
        assert self.op is Op.CONST and self.type is Type.FLOAT and isinstance(self.value, tuple)
        return float(self.value[0])

    @property
    def numbers(self) -> tuple[float, ...]:
        """The components of a constant."""
        assert self.op is Op.CONST and isinstance(self.value, tuple)
        return tuple(float(v) for v in self.value)


class FieldGraph:
    """All expressions of one compilation. Equal expressions are one node; constants fold in float64 as they are added."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[object, ...], Expr] = {}

    def __len__(self) -> int:
        return len(self._nodes)

    def _intern(self, op: Op, type_: Type, args: tuple[Expr, ...], value: Value) -> Expr:
        # repr keeps -0.0 and 0.0 apart, and makes NaN equal to itself
        key = (op, type_, tuple(a.id for a in args), repr(value))
        node = self._nodes.get(key)
        if node is None:
            node = self._nodes[key] = Expr(self, len(self._nodes), op, type_, args, value)
        return node

    def constant(self, *components: Number) -> Expr:
        values = tuple(float(c) for c in components)
        return self._intern(Op.CONST, Type(len(values)), (), values)

    def boolean(self, value: bool) -> Expr:
        return self._intern(Op.CONST, Type.BOOL, (), (float(value),))

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
        if not all(a.op is Op.CONST for a in args):
            simple = _simplify(self, op, args, value)
            if simple is not None:
                return simple
        type_ = _result_type(op, args, value)
        if args and all(a.op is Op.CONST for a in args):
            folded = _fold(op, [a.numbers for a in args], type_.size, value)
            return self._intern(Op.CONST, type_, (), folded)
        return self._intern(op, type_, args, value)

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
    match op:
        case Op.VECTOR:
            return Type(len(args))
        case Op.SWIZZLE:
            assert isinstance(value, tuple)
            return Type(len(value))
        case Op.DOT | Op.LENGTH:
            return Type.FLOAT
        case Op.SELECT:
            return max((args[1].type, args[2].type), key=lambda t: t.value)
        case _ if op in COMPARISON or op in LOGIC:
            return Type.BOOL
        case _:
            return max((a.type for a in args), key=lambda t: t.value)


def _simplify(graph: FieldGraph, op: Op, args: tuple[Expr, ...], value: Value) -> Expr | None:
    """An equal, simpler node, or None. Only rewrites that are exact in real arithmetic for finite values."""

    def zero(e: Expr) -> bool:
        return e.op is Op.CONST and not any(e.numbers)

    def one(e: Expr) -> bool:
        return e.op is Op.CONST and e.type is not Type.BOOL and all(v == 1.0 for v in e.numbers)

    def same_size(e: Expr, other: Expr) -> bool:
        return e.type.value >= other.type.value

    match op, args:
        case Op.ADD, (a, b):
            if zero(b) and same_size(a, b):
                return a
            if zero(a) and same_size(b, a):
                return b
        case Op.SUB, (a, b):
            if zero(b) and same_size(a, b):
                return a
            if zero(a) and same_size(b, a):
                return graph.add(Op.NEG, b)
        case Op.MUL, (a, b):
            if one(b) and same_size(a, b):
                return a
            if one(a) and same_size(b, a):
                return b
            if zero(a) or zero(b):
                return graph.constant(*([0.0] * max(a.type.size, b.type.size)))
        case Op.DIV, (a, b) if one(b) and same_size(a, b):
            return a
        case Op.NEG, (a,) if a.op is Op.NEG:
            return a.args[0]
        case (Op.MIN | Op.MAX), (a, b) if a is b:
            return a
        case Op.SELECT, (condition, a, b):
            if a is b:
                return a
            if condition.op is Op.CONST and a.type is b.type:
                return a if condition.numbers[0] else b
        case Op.AND, (a, b):
            if a.op is Op.CONST:
                return b if a.numbers[0] else a
            if b.op is Op.CONST:
                return a if b.numbers[0] else b
        case Op.OR, (a, b):
            if a.op is Op.CONST:
                return a if a.numbers[0] else b
            if b.op is Op.CONST:
                return b if b.numbers[0] else a
        case Op.SWIZZLE, (a,):
            assert isinstance(value, tuple)
            if value == tuple(range(a.type.size)):
                return a
            if a.op is Op.VECTOR:
                picked = [a.args[int(i)] for i in value]
                return picked[0] if len(picked) == 1 else graph.add(Op.VECTOR, *picked)
            if a.op is Op.SWIZZLE:
                assert isinstance(a.value, tuple)
                return graph.swizzle(a.args[0], tuple(int(a.value[int(i)]) for i in value))
        case Op.VECTOR, (first, *rest):
            whole = first.args[0] if first.op is Op.SWIZZLE else None
            if whole is not None and whole.type.size == len(args):
                parts = [a for a in args if a.op is Op.SWIZZLE and a.args[0] is whole]
                if len(parts) == len(args) and [a.value for a in parts] == [(i,) for i in range(len(args))]:
                    return whole
    return None


def _guarded(function: Callable[..., float]) -> Callable[..., float]:
    """IEEE behaviour for what Python's math raises on: infinities and NaN are reported by the caller, with a place."""

    def call(*values: float) -> float:
        try:
            return function(*values)
        except ZeroDivisionError:
            return math.inf if values[0] > 0 else -math.inf if values[0] < 0 else math.nan
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return call


def _sign(x: float) -> float:
    return float((x > 0) - (x < 0))


_SCALAR: dict[Op, Callable[..., float]] = {
    Op.NEG: lambda a: -a,
    Op.ABS: abs,
    Op.SIGN: _sign,
    Op.FLOOR: lambda a: float(math.floor(a)),
    Op.ROUND: lambda a: float(math.floor(a + 0.5)),
    Op.SQRT: math.sqrt,
    Op.SIN: math.sin,
    Op.COS: math.cos,
    Op.TAN: math.tan,
    Op.ASIN: math.asin,
    Op.ACOS: math.acos,
    Op.ATAN: math.atan,
    Op.EXP: math.exp,
    Op.LOG: math.log,
    Op.ADD: lambda a, b: a + b,
    Op.SUB: lambda a, b: a - b,
    Op.MUL: lambda a, b: a * b,
    Op.DIV: lambda a, b: a / b,
    Op.MIN: min,
    Op.MAX: max,
    Op.MOD: lambda a, b: a - b * math.floor(a / b),
    Op.POW: math.pow,
    Op.ATAN2: math.atan2,
    Op.LESS: lambda a, b: float(a < b),
    Op.LESS_EQUAL: lambda a, b: float(a <= b),
    Op.EQUAL: lambda a, b: float(a == b),
    Op.AND: lambda a, b: float(bool(a) and bool(b)),
    Op.OR: lambda a, b: float(bool(a) or bool(b)),
    Op.NOT: lambda a: float(not a),
}


def _fold(op: Op, args: list[tuple[float, ...]], size: int, value: Value) -> tuple[float, ...]:
    def component(values: tuple[float, ...], index: int) -> float:
        return values[index] if len(values) > 1 else values[0]

    match op:
        case Op.VECTOR:
            return tuple(a[0] for a in args)
        case Op.SWIZZLE:
            assert isinstance(value, tuple)
            return tuple(args[0][int(i)] for i in value)
        case Op.DOT:
            return (math.fsum(a * b for a, b in zip(args[0], args[1], strict=True)),)
        case Op.LENGTH:
            return (math.hypot(*args[0]),)
        case Op.SELECT:
            chosen = args[1] if args[0][0] else args[2]
            return tuple(component(chosen, i) for i in range(size))
        case _:
            function = _guarded(_SCALAR[op])
            return tuple(function(*(component(a, i) for a in args)) for i in range(size))


def topological(roots: Iterable[Expr]) -> Iterator[Expr]:
    """Every node below the roots, arguments before users, each once. Iterative: depth is no limit."""
    done: set[int] = set()
    stack: list[tuple[Expr, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, expanded = stack.pop()
        if node.id in done:
            continue
        if expanded:
            done.add(node.id)
            yield node
        else:
            stack.append((node, True))
            stack.extend((a, False) for a in node.args if a.id not in done)


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
