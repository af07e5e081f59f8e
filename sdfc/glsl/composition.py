"""How one field operation is written in GLSL, given the text of its operands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum
from functools import lru_cache
from itertools import product
from typing import NamedTuple, TypeAlias

from sdfc.field.graph import Expr, Op, Type
from sdfc.glsl.names import identifier, literal, param_name, type_name


class Level(IntEnum):
    """How tightly a text binds (GLSL 4.60 section 5.1); an operand that binds more loosely gets parentheses."""

    CHOICE = 2
    OR = 3
    AND = 5
    EQUALITY = 8
    RELATION = 9
    SUM = 11
    PRODUCT = 12
    UNARY = 14
    ATOM = 15


class Text(NamedTuple):
    """An expression as GLSL."""

    text: str
    level: Level = Level.ATOM
    depth: int = 0  # of nested operations
    is_name: bool = False  # a variable or components of one: may be repeated at no cost

    def within(self, level: int) -> str:
        """The text as an operand of an operator of that level; never begins with a minus."""
        return self.text if self.level >= level and not self.text.startswith("-") else f"({self.text})"

    def leading(self, level: Level) -> str:
        """The text as the first operand, where a minus may stand."""
        return self.text if self.level >= level else f"({self.text})"


Lookup: TypeAlias = Callable[[Expr], Text]

_CONST = Op.CONST  # members of enums are dear to look up
_INFIX = {  # operator, level, and whether operands of the same level need no brackets on the right either
    Op.ADD: (" + ", Level.SUM, False),
    Op.SUB: (" - ", Level.SUM, False),
    Op.MUL: (" * ", Level.PRODUCT, False),
    Op.DIV: (" / ", Level.PRODUCT, False),
    Op.LESS: (" < ", Level.RELATION, False),
    Op.LESS_EQUAL: (" <= ", Level.RELATION, False),
    Op.EQUAL: (" == ", Level.EQUALITY, False),
    Op.AND: (" && ", Level.AND, True),
    Op.OR: (" || ", Level.OR, True),
}

_CALLS = {
    Op.DOT: "dot",
    Op.LENGTH: "length",
    Op.ABS: "abs",
    Op.SIGN: "sign",
    Op.FLOOR: "floor",
    Op.SQRT: "sqrt",
    Op.SIN: "sin",
    Op.COS: "cos",
    Op.TAN: "tan",
    Op.ASIN: "asin",
    Op.ACOS: "acos",
    Op.ATAN: "atan",
    Op.EXP: "exp",
    Op.LOG: "log",
    Op.MIN: "min",
    Op.MAX: "max",
    Op.MOD: "mod",
    Op.POW: "pow",
    Op.ATAN2: "atan",
}

# the letters of a swizzle, by its indices
_LETTERS: dict[tuple[float, ...], str] = {
    indices: "".join(["xyzw"[i] for i in indices])
    for size in (1, 2, 3, 4)
    for indices in product(range(4), repeat=size)
}

# GLSL takes (vector, float) for these, but no (float, vector); for the others of two operands both must be alike.
_FLOAT_SECOND = frozenset({Op.MIN, Op.MAX, Op.MOD})
_EXACT_NEGATION = {Op.ADD: " - ", Op.SUB: " + "}


def compose(node: Expr, text_of: Lookup) -> Text:
    """The GLSL of a node; the texts of its arguments are asked of `text_of`."""
    if not node.args:
        return leaf(node)
    return written(node, text_of, 1 + max([text_of(a).depth for a in node.args]))


def written(node: Expr, text_of: Lookup, depth: int) -> Text:
    """The GLSL of a node that has arguments, told how deep it nests."""
    return _WRITERS[node.op](node, text_of, depth)


def leaf(node: Expr) -> Text:
    """The GLSL of a constant, or of what has a name of its own."""
    if node.op is _CONST:
        return constant(node.type, node.numbers)
    return Text((identifier if node.op is Op.INPUT else param_name)(str(node.value)), is_name=True)


@lru_cache(maxsize=4096)
def constant(type_: Type, numbers: tuple[float, ...]) -> Text:
    """A constant as a literal or a constructor."""
    if type_ is Type.BOOL:
        return Text("true" if numbers[0] else "false")
    if type_ is Type.FLOAT:
        return Text(literal(numbers[0]), Level.UNARY if numbers[0] < 0 else Level.ATOM)
    components = [literal(n) for n in numbers]
    alike = components[:1] if len(set(components)) == 1 else components
    return Text(f"{type_name(type_)}({', '.join(alike)})")


def clamp_limits(node: Expr) -> tuple[Expr, Expr, Expr] | None:
    """(x, lo, hi) if the node is min(max(x, lo), hi) and lo <= hi: GLSL leaves the other case undefined."""
    inner, hi = node.args if node.op is Op.MIN else (node, node)
    if node.op is not Op.MIN or inner.op is not Op.MAX:
        return None
    x, lo = inner.args
    if lo.is_constant and hi.is_constant:
        ordered = max(lo.numbers) <= min(hi.numbers) or (
            lo.type is hi.type and all(a <= b for a, b in zip(lo.numbers, hi.numbers, strict=True))
        )
    else:
        # the idiom clamp(p, -half, half), of a half size that is never negative
        ordered = lo.op is Op.NEG and lo.args[0] is hi and hi.op in (Op.INPUT, Op.PARAM)
    return (x, lo, hi) if ordered else None


def clamp(limits: tuple[Expr, Expr, Expr], type_: Type, text_of: Lookup) -> Text:
    """GLSL's clamp of what `clamp_limits` found."""
    x, lo, hi = limits
    depth = 1 + max(text_of(e).depth for e in limits)
    first = _spread(x, type_, text_of)
    if lo.type is hi.type is Type.FLOAT:
        return Text(f"clamp({first}, {text_of(lo).text}, {text_of(hi).text})", depth=depth)
    return Text(f"clamp({first}, {_spread(lo, type_, text_of)}, {_spread(hi, type_, text_of)})", depth=depth)


def _spread(e: Expr, type_: Type, text_of: Lookup) -> str:
    """The text of e, as a vector if a vector is wanted of a float."""
    return text_of(e).text if e.type.size >= type_.size else f"{type_name(type_)}({text_of(e).text})"


def operands(node: Expr) -> Sequence[Expr]:
    """What the text of a node is made of: its arguments, each that is written once given once, and a vector where they
    are all of its components."""
    if node.op is not Op.VECTOR:
        return node.args
    if all(a is node.args[0] for a in node.args):
        return node.args[:1]
    found: list[Expr] = []
    rest = node.args
    while rest:
        whole = _whole(rest)
        found.append(rest[0] if whole is None else whole)
        rest = rest[1 if whole is None else whole.type.size :]
    return found


def _whole(arguments: Sequence[Expr]) -> Expr | None:
    """The vector whose components, all of them in order, the arguments begin with."""
    vector = arguments[0].args[0] if arguments[0].op is Op.SWIZZLE else None
    if vector is None or not 1 < vector.type.size <= len(arguments):
        return None
    components = enumerate(arguments[: vector.type.size])
    return (
        vector if all(a.op is Op.SWIZZLE and a.args[0] is vector and a.value == (i,) for i, a in components) else None
    )


def _vector(node: Expr, text_of: Lookup, depth: int) -> Text:
    made_of = operands(node)
    if len(made_of) == 1:
        return Text(f"{type_name(node.type)}({text_of(made_of[0]).text})", depth=depth)
    parts: list[
        tuple[Text | None, str]
    ] = []  # (the vector that components are taken of, their letters) or (None, text)
    for argument in made_of:
        whole, letters = _component(argument, text_of)
        if whole is not None and parts and parts[-1][0] == whole:
            parts[-1] = (whole, parts[-1][1] + letters)
        else:
            parts.append((whole, letters))
    texts = [letters if whole is None else f"{whole.text}.{letters}" for whole, letters in parts]
    if len(parts) == 1:
        return Text(texts[0], is_name=True)
    return Text(f"{type_name(node.type)}({', '.join(texts)})", depth=depth)


def _component(e: Expr, text_of: Lookup) -> tuple[Text | None, str]:
    """A component of a variable as the variable and a letter; anything else as (None, its text)."""
    if e.op is Op.SWIZZLE and e.args[0].type.size > 1:
        whole = text_of(e.args[0])
        letters = _letters(e)
        if whole.is_name and text_of(e).text == f"{whole.text}.{letters}":
            return whole, letters
    return None, text_of(e).text


def _letters(swizzle: Expr) -> str:
    assert isinstance(swizzle.value, tuple)
    return _LETTERS[swizzle.value]


def _swizzle(node: Expr, text_of: Lookup, depth: int) -> Text:
    base = text_of(node.args[0])
    if node.args[0].type is Type.FLOAT:
        return Text(f"{type_name(node.type)}({base.text})", depth=depth)
    return Text(f"{base.within(Level.ATOM)}.{_letters(node)}", depth=base.depth, is_name=base.is_name)


def _not(node: Expr, text_of: Lookup, depth: int) -> Text:
    return Text(f"!{text_of(node.args[0]).within(Level.UNARY)}", Level.UNARY, depth)


def _rounded(node: Expr, text_of: Lookup, depth: int) -> Text:
    return Text(f"floor({text_of(node.args[0]).leading(Level.SUM)} + 0.5)", depth=depth)


def _negation(node: Expr, text_of: Lookup, depth: int) -> Text:
    operand = text_of(node.args[0])
    # -a * b is (-a) * b, which rounds as -(a * b) does
    if operand.level >= Level.PRODUCT and not operand.text.startswith("-"):
        return Text(f"-{operand.text}", min(operand.level, Level.UNARY), depth)
    return Text(f"-({operand.text})", Level.UNARY, depth)


def _choice(node: Expr, text_of: Lookup, depth: int) -> Text:
    condition, then, otherwise = node.args
    chosen = _spread(then, node.type, text_of)
    if then.type is node.type and text_of(then).level is Level.CHOICE:
        chosen = f"({chosen})"
    other = _spread(otherwise, node.type, text_of)
    return Text(f"{text_of(condition).within(Level.OR)} ? {chosen} : {other}", Level.CHOICE, depth)


def _infix(node: Expr, text_of: Lookup, depth: int) -> Text:
    operator, level, associates = _INFIX[node.op]
    first, second = node.args
    right = text_of(second)
    if second.op is _CONST and node.op in _EXACT_NEGATION and max(second.numbers) <= 0.0 and not right.is_name:
        operator = _EXACT_NEGATION[node.op]
        right = constant(second.type, tuple([-n for n in second.numbers]))
    inner = right.within(level if associates else level + 1)
    return Text(f"{text_of(first).leading(level)}{operator}{inner}", level, depth)


def _call(node: Expr, text_of: Lookup, depth: int) -> Text:
    args = node.args
    if node.op in (Op.MIN, Op.MAX) and args[0].type.size < args[1].type.size:
        args = (args[1], args[0])
    if node.op in _FLOAT_SECOND:
        texts = [_spread(args[0], node.type, text_of), text_of(args[1]).text]
    elif len(args) == 2 and node.op is not Op.DOT:
        texts = [_spread(a, node.type, text_of) for a in args]
    else:
        texts = [text_of(a).text for a in args]
    return Text(f"{_CALLS[node.op]}({', '.join(texts)})", depth=depth)


_WRITERS: dict[Op, Callable[[Expr, Lookup, int], Text]] = {
    **dict.fromkeys(_CALLS, _call),
    **dict.fromkeys(_INFIX, _infix),
    Op.VECTOR: _vector,
    Op.SWIZZLE: _swizzle,
    Op.NEG: _negation,
    Op.NOT: _not,
    Op.ROUND: _rounded,
    Op.SELECT: _choice,
}
