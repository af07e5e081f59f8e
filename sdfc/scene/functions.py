"""GLSL's functions and operators on expressions, checked: what scenes and fields both compute with."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sdfc.diagnostics import SceneError, Span, scene_error
from sdfc.field.graph import Expr, FieldGraph, Op, Type

CONSTANTS: Mapping[str, float] = MappingProxyType({"pi": math.pi, "tau": math.tau, "inf": math.inf})

_NEAREST_ZERO = 1e-20  # of `nonzero`: its inverse and products of that with lengths stay finite in float32

_NUMBERS = frozenset({Type.FLOAT})
_NAMES = {Type.BOOL: "a boolean", Type.FLOAT: "a number"}


def type_words(type_: Type) -> str:
    """What a type is called in a message."""
    return _NAMES.get(type_) or f"a vector of {type_.size}"


def _joined(types: Sequence[Type]) -> str:
    return " and ".join(type_words(t) for t in types)


def common_size(what: str, args: Sequence[Expr], span: Span) -> int:
    """The size of a component-by-component result; a number goes with any vector."""
    types = {a.type for a in args}
    if types <= _NUMBERS:
        return 1
    if Type.BOOL in types:
        raise scene_error(f"{what} takes numbers and vectors, not {_joined([a.type for a in args])}", span)
    vector, *others = types - _NUMBERS
    if others:
        raise scene_error(f"{what} cannot mix {_joined([a.type for a in args])}", span)
    return vector.size


# --- operators

_ARITHMETIC = {"+": Op.ADD, "-": Op.SUB, "*": Op.MUL, "/": Op.DIV}


def arithmetic(operator: str, a: Expr, b: Expr, span: Span) -> Expr:
    """`a operator b` for + - * /."""
    common_size(f"'{operator}'", (a, b), span)
    return a.graph.add(_ARITHMETIC[operator], a, b)


def negative(a: Expr, span: Span) -> Expr:
    common_size("'-'", (a,), span)
    return -a


def compare(operator: str, a: Expr, b: Expr, span: Span) -> Expr:
    """`a operator b` for < <= > >= == !=, of numbers; the last two of booleans also."""
    graph = a.graph
    equality = operator in ("==", "!=")
    if a.type is not b.type or a.type not in ((Type.FLOAT, Type.BOOL) if equality else (Type.FLOAT,)):
        raise scene_error(f"'{operator}' compares two numbers, not {_joined([a.type, b.type])}", span)
    match operator:
        case "<":
            return a < b
        case "<=":
            return a <= b
        case ">":
            return b < a
        case ">=":
            return b <= a
    if a.type is Type.BOOL:
        same = graph.add(Op.OR, graph.add(Op.AND, a, b), graph.add(Op.AND, negation(a), negation(b)))
    else:
        same = graph.add(Op.EQUAL, a, b)
    return same if operator == "==" else negation(same)


def negation(a: Expr) -> Expr:
    return a.graph.add(Op.NOT, a)


def logic(operator: str, a: Expr, b: Expr) -> Expr:
    """`a operator b` for booleans and `and`, `or`."""
    return a.graph.add(Op.AND if operator == "and" else Op.OR, a, b)


def choose(condition: Expr, then: Expr, otherwise: Expr, span: Span) -> Expr:
    """`if condition then then else otherwise`, of one size (a number beside a vector is spread)."""
    if then.type is not otherwise.type:
        size = common_size("'if'", (then, otherwise), span)
        then, otherwise = spread(then, size), spread(otherwise, size)
    return then.graph.select(condition, then, otherwise)


def spread(value: Expr, size: int) -> Expr:
    """A number as a vector of equal components; a vector as it is."""
    return value.graph.vector(*[value] * size) if value.type is Type.FLOAT and size > 1 else value


# --- functions


@dataclass(frozen=True, slots=True)
class Function:
    """A row: how many arguments, and the expression. `angle` says which unit goes in or comes out."""

    least: int
    most: int
    build: Callable[[FieldGraph, Sequence[Expr], Span], Expr]
    takes_angle: bool = False
    gives_angle: bool = False
    keeps_unit: bool = False  # of its first argument, which the others share


def _each(name: str, op: Op) -> Callable[[FieldGraph, Sequence[Expr], Span], Expr]:
    def build(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
        common_size(name, args, span)
        return graph.add(op, *args)

    return build


def _extreme(name: str, op: Op) -> Callable[[FieldGraph, Sequence[Expr], Span], Expr]:
    """Of any number of arguments; of one vector, its components."""

    def build(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
        common_size(name, args, span)
        parts = components(args[0]) if len(args) == 1 else args
        result = parts[0]
        for other in parts[1:]:
            result = graph.add(op, result, other)
        return result

    return build


def components(value: Expr) -> list[Expr]:
    """The parts of a vector; a number is its own."""
    return [value] if value.type.value < 2 else [value[i] for i in range(value.type.size)]


def _formula(name: str, formula: Callable[..., Expr]) -> Callable[[FieldGraph, Sequence[Expr], Span], Expr]:
    def build(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
        common_size(name, args, span)
        return formula(graph, *args)

    return build


def _vectors(name: str, formula: Callable[..., Expr], *types: Type) -> Callable[..., Expr]:
    def build(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
        if args[0].type not in types or any(a.type is not args[0].type for a in args):
            raise scene_error(f"{name} takes {' or '.join(type_words(t) for t in types)}, "
                              f"not {_joined([a.type for a in args])}", span)  # fmt: skip
        return formula(graph, *args)

    return build


def _components(formula: Callable[[FieldGraph, Expr], Expr]) -> Callable[[FieldGraph, Expr], Expr]:
    def build(graph: FieldGraph, value: Expr) -> Expr:
        if value.type is Type.FLOAT:
            return formula(graph, value)
        return graph.vector(*[formula(graph, value[i]) for i in range(value.type.size)])

    return build


def _step(graph: FieldGraph, edge: Expr, x: Expr) -> Expr:
    return _components(lambda g, d: g.select(d < 0.0, 0.0, 1.0))(graph, x - edge)


def _smoothstep(graph: FieldGraph, low: Expr, high: Expr, x: Expr) -> Expr:
    t = graph.clamp((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _cross(graph: FieldGraph, a: Expr, b: Expr) -> Expr:
    return graph.cross(a, b) if a.type is Type.VEC3 else a[0] * b[1] - a[1] * b[0]


def _nonzero(graph: FieldGraph, x: Expr) -> Expr:
    return graph.select(graph.abs(x) < _NEAREST_ZERO, graph.select(x < 0.0, -_NEAREST_ZERO, _NEAREST_ZERO), x)


def _length(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
    common_size("length", args, span)
    return graph.abs(args[0]) if args[0].type is Type.FLOAT else graph.length(args[0])


def _atan(graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
    common_size("atan", args, span)
    return graph.add(Op.ATAN if len(args) == 1 else Op.ATAN2, *args)


_SPACES = (Type.VEC2, Type.VEC3, Type.VEC4)
_MANY = 1 << 30

FUNCTIONS: Mapping[str, Function] = MappingProxyType(
    {
        "abs": Function(1, 1, _each("abs", Op.ABS), keeps_unit=True),
        "sign": Function(1, 1, _each("sign", Op.SIGN)),
        "floor": Function(1, 1, _each("floor", Op.FLOOR)),
        "ceil": Function(1, 1, _formula("ceil", lambda g, x: -g.add(Op.FLOOR, -x))),
        "round": Function(1, 1, _each("round", Op.ROUND)),
        "fract": Function(1, 1, _formula("fract", lambda g, x: x - g.add(Op.FLOOR, x))),
        "sqrt": Function(1, 1, _each("sqrt", Op.SQRT)),
        "exp": Function(1, 1, _each("exp", Op.EXP)),
        "log": Function(1, 1, _each("log", Op.LOG)),
        "sin": Function(1, 1, _each("sin", Op.SIN), takes_angle=True),
        "cos": Function(1, 1, _each("cos", Op.COS), takes_angle=True),
        "tan": Function(1, 1, _each("tan", Op.TAN), takes_angle=True),
        "asin": Function(1, 1, _each("asin", Op.ASIN), gives_angle=True),
        "acos": Function(1, 1, _each("acos", Op.ACOS), gives_angle=True),
        "atan": Function(1, 2, _atan, gives_angle=True),
        "radians": Function(1, 1, _formula("radians", lambda g, x: x * (math.pi / 180)), gives_angle=True),
        "degrees": Function(1, 1, _formula("degrees", lambda g, x: x * (180 / math.pi)), takes_angle=True),
        "min": Function(1, _MANY, _extreme("min", Op.MIN), keeps_unit=True),
        "max": Function(1, _MANY, _extreme("max", Op.MAX), keeps_unit=True),
        "mod": Function(2, 2, _formula("mod", lambda g, a, b: g.add(Op.MOD, a, b)), keeps_unit=True),
        "pow": Function(2, 2, _formula("pow", lambda g, a, b: g.add(Op.POW, a, b))),
        "clamp": Function(3, 3, _formula("clamp", lambda g, x, a, b: g.clamp(x, a, b)), keeps_unit=True),
        "mix": Function(3, 3, _formula("mix", lambda g, a, b, t: a + (b - a) * t), keeps_unit=True),
        "step": Function(2, 2, _formula("step", _step)),
        "smoothstep": Function(3, 3, _formula("smoothstep", _smoothstep)),
        "length": Function(1, 1, _length),
        "dot": Function(2, 2, _vectors("dot", lambda g, a, b: g.dot(a, b), *_SPACES)),
        "cross": Function(2, 2, _vectors("cross", _cross, Type.VEC2, Type.VEC3)),
        "normalize": Function(1, 1, _vectors("normalize", lambda g, a: a / g.length(a), *_SPACES)),
        "nonzero": Function(1, 1, _formula("nonzero", _components(_nonzero))),
    }
)

# over the values of loops: `sum(for v in list: …)`; min and max are functions of many arguments anyway
FOLDS: Mapping[str, tuple[str, float]] = MappingProxyType({"sum": ("+", 0.0), "product": ("*", 1.0)})


def call(name: str, graph: FieldGraph, args: Sequence[Expr], span: Span) -> Expr:
    """The function `name` of FUNCTIONS or FOLDS."""
    if name in FOLDS:
        operator, start = FOLDS[name]
        parts = components(args[0]) if len(args) == 1 else args
        common_size(name, parts, span)
        result = parts[0] if parts else graph.constant(start)
        for value in parts[1:]:
            result = arithmetic(operator, result, value, span)
        return result
    row = FUNCTIONS[name]
    if not row.least <= len(args) <= row.most:
        raise wrong_count(name, row, len(args), span)
    return row.build(graph, args, span)


def wrong_count(name: str, row: Function, given: int, span: Span) -> SceneError:
    counts = {row.least, row.most} - {_MANY}
    wanted = " or ".join(str(c) for c in sorted(counts)) + (" or more" if row.most == _MANY else "")
    return scene_error(f"{name} takes {wanted} argument{'' if counts == {1} else 's'}, not {given}", span)


# --- parts of vectors

_LETTERS = {letters[i]: i for letters in ("xyzw", "rgba") for i in range(4)}


def swizzle(value: Expr, letters: str, span: Span) -> Expr | None:
    """`value.letters`, or None where the letters are no swizzle."""
    one_set = set(letters) <= set("xyzw") or set(letters) <= set("rgba")
    if not (1 <= len(letters) <= 4 and one_set):
        return None
    if value.type is Type.BOOL or max(_LETTERS[c] for c in letters) >= value.type.size:
        raise scene_error(f"{type_words(value.type)} has no '.{letters}'", span)
    if value.type is Type.FLOAT:
        return spread(value, len(letters))
    return value.graph.swizzle(value, tuple(_LETTERS[c] for c in letters))
