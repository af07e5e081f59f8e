"""Random field expressions for property tests: recipes that can be built in any graph, simplifying or not."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

import numpy as np
from hypothesis import strategies as st

from sdfc.field.graph import BINARY, COMPARISON, LOGIC, UNARY, Expr, FieldGraph, Op, Type, Value, _result_type

INPUTS = {"t": Type.FLOAT, "u": Type.VEC2, "p": Type.VEC3, "w": Type.VEC4}
PARAMS = {"alpha": Type.FLOAT, "beta": Type.VEC3}
VECTORS = (Type.VEC2, Type.VEC3, Type.VEC4)
SMOOTH_UNARY = (Op.NEG, Op.SQRT, Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN, Op.EXP, Op.LOG)
SMOOTH_BINARY = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.POW, Op.ATAN2)


@dataclass(frozen=True, slots=True)
class Recipe:
    """An expression to be built: an operation, what it is applied to, and a leaf's type."""

    op: Op
    args: tuple[Recipe, ...] = ()
    value: Value = None
    type: Type = Type.FLOAT

    def build(self, graph: FieldGraph, made: dict[int, Expr] | None = None) -> Expr:
        """The expression in a graph. `made` remembers what shared parts became."""
        made = {} if made is None else made
        if id(self) not in made:
            made[id(self)] = self._build(graph, made)
        return made[id(self)]

    def _build(self, graph: FieldGraph, made: dict[int, Expr]) -> Expr:
        match self.op:
            case Op.CONST:
                assert isinstance(self.value, tuple)
                return graph.boolean(bool(self.value[0])) if self.type is Type.BOOL else graph.constant(*self.value)
            case Op.INPUT:
                return graph.input(str(self.value), self.type)
            case Op.PARAM:
                return graph.param(str(self.value), self.type)
            case _:
                return graph.add(self.op, *(a.build(graph, made) for a in self.args), value=self.value)


class PlainGraph(FieldGraph):
    """A graph that neither simplifies nor folds: what the simplified one is compared with."""

    def add(self, op: Op, *args: Expr, value: Value = None) -> Expr:
        return self._made.get((op, args, value)) or self._made.setdefault(
            (op, args, value), self._new(op, _result_type(op, args, value), args, value)
        )


def number(x: float) -> Recipe:
    return Recipe(Op.CONST, value=(x,))


def node(op: Op, *args: Recipe, value: Value = None) -> Recipe:
    return Recipe(op, args, value)


def points(count: int, seed: int = 0) -> dict[str, np.ndarray]:
    """Random values for INPUTS."""
    random = np.random.default_rng(seed)
    shapes = {name: (count,) if type_ is Type.FLOAT else (type_.size, count) for name, type_ in INPUTS.items()}
    return {name: random.uniform(-2.0, 2.0, shape).astype(np.float32).astype(float) for name, shape in shapes.items()}


PARAM_VALUES = {"alpha": 0.75, "beta": (0.5, -1.25, 0.25)}


@st.composite
def trees(draw: st.DrawFn, type_: Type = Type.FLOAT, steps: int = 30, smooth: bool = False) -> Recipe:
    """An expression of a type whose values are finite at `points`: the last of some steps, each made of earlier ones.

    A smooth one has no kinks and no steps near the points. Hypothesis chooses (and shrinks) the number of steps and a
    seed; left to itself it draws mostly tiny expressions.
    """
    count = draw(st.integers(1, steps))
    return _Growth(Random(draw(st.integers(0, 2**32))), smooth).grow(type_, count)


class _Growth:
    """A pool of expressions of each type, to which steps add."""

    def __init__(self, random: Random, smooth: bool) -> None:
        self._random = random
        self._smooth = smooth
        self._unary = SMOOTH_UNARY if smooth else tuple(sorted(UNARY, key=lambda op: op.value))
        self._binary = SMOOTH_BINARY if smooth else tuple(sorted(BINARY, key=lambda op: op.value))
        self._pool = {t: _leaves(t) for t in Type}

    def grow(self, type_: Type, count: int) -> Recipe:
        kinds = [Type.FLOAT, *VECTORS] if self._smooth else [Type.BOOL, Type.FLOAT, Type.FLOAT, *VECTORS]
        for kind in self._random.choices(kinds, k=count):
            self._pool[kind].append(self._step(kind))
        result = self._step(type_)
        while type_ is not Type.BOOL and count > 0:  # what was grown is drawn together
            count -= 3
            result = protected(self._random.choice(self._binary), result, self._operand(type_))
        return result

    def _pick(self, type_: Type) -> Recipe:
        chance = self._random.random()
        if chance < 0.7:
            return self._random.choice(self._pool[type_][-2:])
        if chance < 0.9 or type_ is Type.BOOL:
            return self._random.choice(self._pool[type_])
        plain = self._random.choice([0.0, 1.0, -1.0, 2.0, 0.5])
        numbers = [self._random.randint(-40, 40) / 16.0 if self._random.random() < 0.5 else plain]
        return Recipe(
            Op.CONST, value=tuple(self._random.choice([plain, *numbers]) for _ in range(type_.size)), type=type_
        )

    def _operand(self, type_: Type) -> Recipe:
        """Of the type, or a scalar that is spread over it."""
        return self._pick(Type.FLOAT if self._random.random() < 0.25 else type_)

    def _step(self, type_: Type) -> Recipe:
        if type_ is Type.BOOL:
            return self._condition()
        kind = self._random.choice("uubbppp" if self._smooth else "uubbppps")
        match kind:
            case "u":
                return protected(self._random.choice(self._unary), self._pick(type_))
            case "b":
                pair = [self._pick(type_), self._operand(type_)]
                self._random.shuffle(pair)
                return protected(self._random.choice(self._binary), *pair)
            case "s":
                return node(Op.SELECT, self._pick(Type.BOOL), self._pick(type_), self._operand(type_))
            case _:
                return self._rearranged(type_)

    def _rearranged(self, type_: Type) -> Recipe:
        source = self._random.choice(VECTORS)
        if self._random.random() < 0.4:
            return node(
                Op.SWIZZLE, self._pick(source), value=tuple(self._random.choices(range(source.size), k=type_.size))
            )
        if type_ is not Type.FLOAT:
            return node(Op.VECTOR, *(self._pick(Type.FLOAT) for _ in range(type_.size)))
        if self._random.random() < 0.5:
            return node(Op.DOT, self._pick(source), self._pick(source))
        return _norm(self._pick(source), source, self._smooth)

    def _condition(self) -> Recipe:
        op = self._random.choice(_CONDITIONS)
        if op is Op.NOT:
            return node(op, self._pick(Type.BOOL))
        kind = Type.FLOAT if op in COMPARISON else Type.BOOL
        return node(op, self._pick(kind), self._pick(kind))


_NUMBERS = st.one_of(st.sampled_from([0.0, 1.0, -1.0, 2.0, 0.5]), st.integers(-40, 40).map(lambda n: n / 16.0))
_CONDITIONS = tuple(sorted(COMPARISON | LOGIC, key=lambda op: op.value))


def _leaves(type_: Type) -> list[Recipe]:
    if type_ is Type.BOOL:
        return [Recipe(Op.CONST, value=(x,), type=Type.BOOL) for x in (0.0, 1.0)]
    named = [Recipe(Op.PARAM, value=name, type=t) for name, t in PARAMS.items() if t is type_]
    named += [Recipe(Op.INPUT, value=name, type=t) for name, t in INPUTS.items() if t is type_]
    if type_ is Type.FLOAT:
        named += [node(Op.SWIZZLE, Recipe(Op.INPUT, value="p", type=Type.VEC3), value=(i,)) for i in range(3)]
    return named


def _norm(vector: Recipe, type_: Type, smooth: bool) -> Recipe:
    """The length. A smooth one keeps away from its kink: of the way from a point outside the box of the sines."""
    far = node(Op.VECTOR, *[number(9.0 + i) for i in range(type_.size)])
    return node(Op.LENGTH, node(Op.SUB, node(Op.SIN, vector), far) if smooth else vector)


def protected(op: Op, *args: Recipe) -> Recipe:
    """The operation on arguments that are bent into its domain, away from its poles."""
    x = args[0]
    match op:
        case Op.SQRT | Op.LOG:
            return node(op, node(Op.ADD, node(Op.MUL, x, x), number(0.5)))
        case Op.TAN | Op.ASIN | Op.ACOS:
            return node(op, node(Op.MUL, node(Op.SIN, x), number(0.875)))
        case Op.EXP:
            return node(op, node(Op.SIN, x))
        case Op.DIV | Op.MOD:
            return node(op, x, node(Op.ADD, node(Op.MUL, args[1], args[1]), number(0.5)))
        case Op.POW:
            base = node(Op.ADD, number(2.5), node(Op.SIN, x))
            return node(op, base, node(Op.SIN, args[1])) if args[1].op is not Op.CONST else node(op, base, args[1])
        case Op.ATAN2:
            return node(op, x, node(Op.ADD, node(Op.MUL, args[1], args[1]), number(0.5)))
        case _:
            return node(op, *args)
