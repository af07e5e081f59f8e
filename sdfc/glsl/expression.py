"""Printing field expressions as GLSL statements that people can read and compilers get through quickly.

What is used twice becomes a local; so does what would make a line too long or nest too deep. A long chain of min and
max becomes one variable that is updated, one statement a step: Mesa's front end needs seconds for a thousand nested
calls of min, and compiles the chain to better code than a tree of temporaries (measured).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

from sdfc.field.function import Function
from sdfc.field.graph import Expr, Op, params_of
from sdfc.field.order import evaluation_order
from sdfc.glsl.composition import Level, Text, clamp, clamp_limits, compose, leaf, operands
from sdfc.glsl.gathered import gathered
from sdfc.glsl.in_place import CHAIN, DEPTH, WIDTH, InPlace, NeedsLocalError
from sdfc.glsl.names import PARAM_PREFIX, Names, identifier, literal, param_name, type_name

__all__ = ["DEPTH", "WIDTH", "Printed", "Printer", "literal", "print_function", "printed", "type_name"]

NamesOf: TypeAlias = Callable[[Expr], str | None]

LARGEST_PRODUCT = 64  # integer powers up to this are written as products


@dataclass(frozen=True, slots=True)
class Printed:
    """A function's definition in GLSL, but for its name and what is said of it."""

    type: str
    parameters: str
    lines: tuple[str, ...]

    def text(self, name: str, doc: str = "") -> str:
        """The definition, under `doc` as a comment."""
        said = [f"// {line}".rstrip().rstrip("\\") for line in doc.splitlines()]
        return "\n".join([*said, f"{self.type} {name}({self.parameters}) {{", *self.lines, "}"]) + "\n"


def printed(function: Function) -> Printed:
    """A function in GLSL. Parameters keep their names where GLSL allows it and no uniform has the same."""
    scope = Names()
    if any(identifier(name).startswith(PARAM_PREFIX) for name, _ in function.parameters):
        scope = Names(map(param_name, params_of([function.result])))
    renamed = {name: scope.fresh(name) for name, _ in function.parameters}

    def name_of(node: Expr) -> str | None:
        if node.op is not _INPUT:
            return None
        assert node.value in renamed, f"{function.name} reads what is no parameter of it"
        return renamed[str(node.value)]

    lines, (result,) = Printer(name_of, scope).block([function.result], function.names)
    parameters = ", ".join(f"{type_name(type_)} {renamed[name]}" for name, type_ in function.parameters)
    body = tuple(f"    {line}" for line in (*lines, f"return {result};"))
    return Printed(type_name(function.result.type), parameters, body)


def print_function(function: Function, name: str | None = None) -> str:
    """The GLSL definition of a function, under its doc string as a comment. `name` is taken as it is."""
    return printed(function).text(name or identifier(function.name), function.doc)


# members of enums are dear to look up, and these are asked for at every node
_CONST, _INPUT, _VECTOR, _SWIZZLE, _POW, _MIN = Op.CONST, Op.INPUT, Op.VECTOR, Op.SWIZZLE, Op.POW, Op.MIN
_EXTREMES = frozenset({Op.MIN, Op.MAX})
_MEMBER = re.compile(r"[A-Za-z_][\w.]*")
_PLAIN_CALL = re.compile(r"\w+\([^()]*\)")


def _no_names(_: Expr) -> None:
    """Nothing has a name yet."""


def local_name(node: Expr) -> str:
    """What a local that holds the node's value is called, but for a number behind it."""
    return "q" if node.type.size > 1 else _LOCAL_NAMES[node.op]


class Printer:
    """Prints expressions for one scope of GLSL; the locals of later calls never repeat the names of earlier ones.

    `names` gives the text of a node that is there already, or None; what is below such a node is not printed. Constants
    are not asked about. `scope` holds the identifiers that locals must not take; names given for nodes are added to it.
    """

    def __init__(self, names: NamesOf = _no_names, scope: Names | None = None) -> None:
        self._names = names
        self._scope = Names() if scope is None else scope

    def statements(self, roots: Sequence[Expr]) -> tuple[list[str], list[str]]:
        """Declarations of locals, and one text for each root.

        A text may be any expression: bracket it before putting it beside an operator.
        """
        try:
            return [], InPlace(self._there).texts(roots)
        except NeedsLocalError:
            return self.block(roots)

    def block(
        self, roots: Sequence[Expr], called: Mapping[Expr, str] = MappingProxyType({})
    ) -> tuple[list[str], list[str]]:
        """The same, sooner where there are locals most likely. What is `called` something is a local of that name."""
        block = _Block(self._there, self._scope, roots, called)
        return block.lines, [block.text_of(root).text for root in roots]

    def _there(self, node: Expr) -> Text | None:
        """The text of a leaf, and of what is there already."""
        if node.op is _CONST:
            return leaf(node)
        given = self._names(node)
        if given is None and node.args:
            return None
        text = leaf(node) if given is None else _given_text(given)
        self._scope.reserve(text.text.partition(".")[0])
        return text


class _Block:
    """The printing of some roots: every node in order of evaluation, its text inline or a local's name."""

    def __init__(
        self, there: Callable[[Expr], Text | None], scope: Names, roots: Sequence[Expr], called: Mapping[Expr, str]
    ) -> None:
        self.lines: list[str] = []
        self._called = called
        self._scope = scope
        self._texts: dict[Expr, Text] = {}
        self.text_of = self._texts.__getitem__
        self._squares: dict[tuple[Expr, int], str] = {}
        inner, given = self._name_leaves(there, roots)
        self._uses = _count_uses(inner, given, roots)
        order = [n for n in _in_order(roots, given) if n in self._uses]
        self._spine = _spines(order, self._uses)
        self._gathered = gathered(order, self._uses, called)
        for node in order:
            if node not in self._texts:
                self._print(node)

    def _name_leaves(
        self, there: Callable[[Expr], Text | None], roots: Sequence[Expr]
    ) -> tuple[list[Expr], list[Expr]]:
        """Before any local is named: the texts of what is there already.

        The nodes that are left to print, arguments before users; and those that are given although they have arguments.
        """
        inner: list[Expr] = []
        given: list[Expr] = []
        is_done: dict[Expr, bool] = {}  # of what is left to print: whether its arguments are among it
        stack = list(reversed(roots))
        while stack:
            node = stack.pop()
            if node in self._texts:
                continue
            if node not in is_done:
                text = there(node)
                if text is None:
                    is_done[node] = False
                    stack.append(node)
                    stack.extend(reversed(node.args))
                    continue
                self._texts[node] = text
                if node.args:
                    given.append(node)
            elif not is_done[node]:
                is_done[node] = True
                inner.append(node)
        return inner, given

    def _print(self, node: Expr) -> None:
        text = self._composed(node)
        while len(text.text) > WIDTH or text.depth > DEPTH:
            candidate = self._worst_argument(node, by_depth=text.depth > DEPTH)
            if candidate is None:
                break
            self._declare(candidate)
            text = self._composed(node)
        self._texts[node] = text
        if node in self._spine:
            self._update(node)
        elif node in self._gathered:
            vector = self._gathered[node]
            if vector is not None:
                self._gather(vector)
        elif (self._uses[node] > 1 or node in self._called) and not self._is_trivial(node):
            self._declare(node)

    def _composed(self, node: Expr) -> Text:
        if node.op is _MIN:
            limits = clamp_limits(node)
            if limits is not None and self._is_inline(node.args[0]):
                return clamp(limits, node.type, self.text_of)
        elif node.op is _POW:
            exponent = _integer_exponent(node)
            if exponent is not None:
                return self._power(node, exponent)
        return compose(node, self.text_of)

    def _is_trivial(self, node: Expr) -> bool:
        """Not worth a local: a name, its components, its negative."""
        is_negative = node.op is Op.NEG and self._texts[node.args[0]].is_name
        return is_negative or node.op is Op.SWIZZLE or self._texts[node].is_name

    def _is_inline(self, node: Expr) -> bool:
        return self._uses.get(node) == 1 and not self._texts[node].is_name

    def _worst_argument(self, node: Expr, by_depth: bool) -> Expr | None:
        """The argument to make a local so that the node gets shorter: no name, no number; a constant vector last."""

        def burden(e: Expr) -> tuple[bool, int, int]:
            text = self._texts[e]
            return e.op is not Op.CONST, text.depth if by_depth else 0, len(text.text)

        candidates = [a for a in operands(node) if (a.args or a.type.size > 1) and not self._texts[a].is_name]
        return max(candidates, key=burden, default=None)

    def _declare(self, node: Expr) -> None:
        self._texts[node] = Text(self._local(node, self._texts[node].text), is_name=True)

    def _gather(self, vector: Expr) -> None:
        """A local of the vector; its components are that one's. Where it gets too long, a local of each."""
        text = self._composed(vector)
        if len(text.text) > WIDTH or text.depth > DEPTH:
            for component in vector.args:
                self._declare(component)
            return
        self._texts[vector] = text
        self._declare(vector)
        name = self._texts[vector].text
        for component, letter in zip(vector.args, "xyzw", strict=False):
            self._texts[component] = Text(f"{name}.{letter}", is_name=True)

    def _local(self, node: Expr, text: str) -> str:
        name = self._scope.fresh(self._called.get(node) or local_name(node))
        self.lines.append(f"{type_name(node.type)} {name} = {text};")
        return name

    def _update(self, node: Expr) -> None:
        """One step of a chain of min and max: its variable is declared by the first, updated by the others."""
        before = self._spine[node]
        if before is None:
            self._declare(node)
        else:
            variable = self._texts[before]
            self.lines.append(f"{variable.text} = {self._texts[node].text};")
            self._texts[node] = variable

    def _power(self, node: Expr, exponent: int) -> Text:
        """An integer power, which GLSL's pow does not know for a negative base."""
        base = node.args[0]
        if not self._texts[base].is_name:
            self._declare(base)
        name = self._texts[base].text
        if abs(exponent) > LARGEST_PRODUCT:
            sign = "" if exponent % 2 == 0 else f"sign({name}) * "
            count = compose(node.args[1], self.text_of).text
            count = count if node.type.size == node.args[1].type.size else f"{type_name(node.type)}({count})"
            return Text(f"{sign}pow(abs({name}), {count})", Level.PRODUCT, depth=2)
        factors = [name] * abs(exponent) if abs(exponent) < 4 else self._square_factors(base, name, abs(exponent))
        product = " * ".join(factors)
        if exponent > 0:
            return Text(product, Level.PRODUCT, depth=1)
        return Text(f"1.0 / ({product})", Level.PRODUCT, depth=2)

    def _square_factors(self, base: Expr, name: str, exponent: int) -> list[str]:
        """Repeated squares of the base, each a local, whose product is the power."""
        factors = []
        power = 1
        while power <= exponent:
            if exponent & power:
                factors.append(name)
            power *= 2
            if power <= exponent:
                key = (base, power)
                if key not in self._squares:
                    self._squares[key] = self._scope.fresh(f"square_{power}")
                    self.lines.append(f"{type_name(base.type)} {self._squares[key]} = {name} * {name};")
                name = self._squares[key]
        return factors


def _given_text(given: str) -> Text:
    """A text from outside: a name, a call of plain arguments, or anything, which then needs brackets."""
    if given.isidentifier() or _MEMBER.fullmatch(given):
        return Text(given, is_name=True)
    return Text(given, Level.ATOM if _PLAIN_CALL.fullmatch(given) else Level.CHOICE)


def _in_order(roots: Sequence[Expr], given: Sequence[Expr]) -> list[Expr]:
    """The order of evaluation; of what is given, nothing below is computed."""
    if not given:
        return evaluation_order(roots)
    without = set(given)
    return evaluation_order(roots, lambda node: () if node in without else node.args)


def _count_uses(inner: Sequence[Expr], given: Sequence[Expr], roots: Sequence[Expr]) -> dict[Expr, int]:
    """How often each inner node's text will be written; what is given counts as a use of its arguments.

    A swizzle is as good as its vector, so it counts as uses of that.
    """
    uses = dict.fromkeys(inner, 0)
    for root in roots:
        if root in uses:
            uses[root] += 1
    for node in (*given, *reversed(inner)):
        count = uses.get(node, 1) if node.op is _SWIZZLE else 1
        for argument in operands(node) if node.op is _VECTOR else node.args:
            if argument in uses:
                uses[argument] += count
    return uses


def _spines(order: Sequence[Expr], uses: dict[Expr, int]) -> dict[Expr, Expr | None]:
    """For each step of a long chain of min and max, the step before it, or None for the first."""
    length: dict[Expr, int] = {}
    before: dict[Expr, Expr | None] = {}
    for node in order:
        if node.op in _EXTREMES and clamp_limits(node) is None:
            steps = [a for a in node.args if a in length and uses[a] == 1 and a.type is node.type]
            longest = max(steps, key=length.__getitem__, default=None)
            before[node] = longest
            length[node] = 1 if longest is None else 1 + length[longest]
    inner_steps = set(before.values())
    chains: dict[Expr, Expr | None] = {}
    for node, steps_below in length.items():
        if steps_below >= CHAIN and node not in inner_steps:
            step: Expr | None = node
            while step is not None:
                chains[step] = before[step]
                step = before[step]
    return chains


def _integer_exponent(node: Expr) -> int | None:
    """n if the node is x to the power of the constant integer n (not 0), else None."""
    if node.op is not _POW or not node.args[1].is_constant or node.args[0].type.size < node.args[1].type.size:
        return None
    exponents = set(node.args[1].numbers)
    exponent = exponents.pop()
    return int(exponent) if not exponents and exponent.is_integer() and exponent != 0.0 else None


_LOCAL_NAMES: dict[Op, str] = {
    Op.CONST: "value",
    Op.INPUT: "value",
    Op.PARAM: "value",
    Op.VECTOR: "value",
    Op.SWIZZLE: "value",
    Op.DOT: "along",
    Op.LENGTH: "len",
    Op.NEG: "opposite",
    Op.ABS: "size",
    Op.SIGN: "side",
    Op.FLOOR: "cell",
    Op.ROUND: "cell",
    Op.SQRT: "root",
    Op.SIN: "sine",
    Op.COS: "cosine",
    Op.TAN: "slope",
    Op.ASIN: "angle",
    Op.ACOS: "angle",
    Op.ATAN: "angle",
    Op.EXP: "power",
    Op.LOG: "logarithm",
    Op.ADD: "sum",
    Op.SUB: "d",
    Op.MUL: "product",
    Op.DIV: "ratio",
    Op.MIN: "d",
    Op.MAX: "d",
    Op.MOD: "rest",
    Op.POW: "power",
    Op.ATAN2: "angle",
    Op.LESS: "below",
    Op.LESS_EQUAL: "within",
    Op.EQUAL: "same",
    Op.AND: "both",
    Op.OR: "either",
    Op.NOT: "outside",
    Op.SELECT: "chosen",
}

# what locals are called, but for a number behind it: no function may be called so, a local would hide it
LOCAL_WORDS = frozenset({"q", *_LOCAL_NAMES.values()})
