"""Printing field expressions as GLSL statements that people can read and compilers get through quickly.

What is used twice becomes a local; so does what would make a line too long or nest too deep. A long chain of min and
max becomes one variable that is updated, one statement a step: Mesa's front end needs seconds for a thousand nested
calls of min, and compiles the chain to better code than a tree of temporaries (measured).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TypeAlias

from sdfc.field.function import Function
from sdfc.field.graph import LEAVES, Expr, Op, topological
from sdfc.field.order import evaluation_order
from sdfc.glsl.composition import Level, Text, clamp, clamp_limits, compose, operands
from sdfc.glsl.gathered import gathered
from sdfc.glsl.names import Names, identifier, literal, param_name, type_name

__all__ = ["Printer", "literal", "print_function", "type_name"]

NamesOf: TypeAlias = Callable[[Expr], str | None]

WIDTH = 90  # characters of one expression
DEPTH = 8  # operations nested in one expression
CHAIN = 4  # so many steps of min and max in a row become updates of one variable
LARGEST_PRODUCT = 64  # integer powers up to this are written as products


def print_function(function: Function, name: str | None = None) -> str:
    """The GLSL definition of a function, under its doc string as a comment.

    Parameters keep their names where GLSL allows it and no uniform has the same. `name` is taken as it is.
    """
    nodes = list(topological([function.result]))
    scope = Names(param_name(str(n.value)) for n in nodes if n.op is Op.PARAM)
    renamed = {name: scope.fresh(name) for name, _ in function.parameters}
    own = {name for name, _ in function.parameters}
    assert all(n.value in own for n in nodes if n.op is Op.INPUT), f"{function.name} reads what is no parameter of it"
    printer = Printer(lambda e: renamed[str(e.value)] if e.op is Op.INPUT else None, scope, function.names)
    lines, (result,) = printer.statements([function.result])
    parameters = ", ".join(f"{type_name(type_)} {renamed[name]}" for name, type_ in function.parameters)
    doc = [f"// {line}".rstrip().rstrip("\\") for line in function.doc.splitlines()]
    head = f"{type_name(function.result.type)} {name or identifier(function.name)}({parameters}) {{"
    body = [f"    {line}" for line in (*lines, f"return {result};")]
    return "\n".join([*doc, head, *body, "}"]) + "\n"


_EXTREMES = frozenset({Op.MIN, Op.MAX})
_NOTHING: Mapping[Expr, str] = MappingProxyType({})


def _no_names(_: Expr) -> None:
    """Nothing has a name yet."""


def local_name(node: Expr) -> str:
    """What a local that holds the node's value is called, but for a number behind it."""
    return "q" if node.type.size > 1 else _LOCAL_NAMES[node.op]


class Printer:
    """Prints expressions for one scope of GLSL; the locals of later calls never repeat the names of earlier ones.

    `names` gives the text of a node that is there already, or None; what is below such a node is not printed. `scope`
    holds the identifiers that locals must not take; names given for nodes are added to it. What is `called` something
    is a local of that name.
    """

    def __init__(
        self, names: NamesOf = _no_names, scope: Names | None = None, called: Mapping[Expr, str] = _NOTHING
    ) -> None:
        self._names = names
        self._scope = Names() if scope is None else scope
        self._called = called

    def statements(self, roots: Iterable[Expr]) -> tuple[list[str], list[str]]:
        """Declarations of locals, and one text for each root.

        A text may be any expression: bracket it before putting it beside an operator.
        """
        roots = list(roots)
        block = _Block(self._names, self._scope, roots, self._called)
        return block.lines, [block.text_of(root).text for root in roots]


class _Block:
    """The printing of some roots: every node in order of evaluation, its text inline or a local's name."""

    def __init__(self, names: NamesOf, scope: Names, roots: Sequence[Expr], called: Mapping[Expr, str]) -> None:
        self.lines: list[str] = []
        self._called = called
        self._scope = scope
        self._texts: dict[int, Text] = {}
        if self._name_leaves(names, roots):
            return
        order = evaluation_order(roots, self._below)
        self._uses = _count_uses(order, roots)
        self._spine = _spines(order, self._uses, self._texts)
        self._gathered = gathered(order, self._uses, called)
        self._squares: dict[tuple[int, int], str] = {}
        for node in order:
            if node.id not in self._texts:
                self._print(node)

    def text_of(self, node: Expr) -> Text:
        return self._texts[node.id]

    def _name_leaves(self, names: NamesOf, roots: Sequence[Expr]) -> bool:
        """Before any local is named: the texts of what is there already. Whether that is all there is to print."""

        def below(node: Expr) -> Sequence[Expr]:
            given = names(node)
            if given is None:
                return node.args
            self._texts[node.id] = _given_text(given)
            return ()

        for node in topological(roots, below):
            if node.op in LEAVES and node.id not in self._texts:
                self._texts[node.id] = compose(node, self.text_of)
            if node.id in self._texts and node.op is not Op.CONST:
                self._scope.reserve(self._texts[node.id].text.partition(".")[0])
        return all(root.id in self._texts for root in roots)

    def _below(self, node: Expr) -> Sequence[Expr]:
        return () if node.id in self._texts else node.args

    def _print(self, node: Expr) -> None:
        text = self._composed(node)
        while len(text.text) > WIDTH or text.depth > DEPTH:
            candidate = self._worst_argument(node, by_depth=text.depth > DEPTH)
            if candidate is None:
                break
            self._declare(candidate)
            text = self._composed(node)
        self._texts[node.id] = text
        if node.id in self._spine:
            self._update(node)
        elif node.id in self._gathered:
            vector = self._gathered[node.id]
            if vector is not None:
                self._gather(vector)
        elif (self._uses[node.id] > 1 or node in self._called) and not self._is_trivial(node):
            self._declare(node)

    def _composed(self, node: Expr) -> Text:
        limits = clamp_limits(node)
        if limits is not None and self._is_inline(node.args[0]):
            return clamp(limits, node.type, self.text_of)
        exponent = _integer_exponent(node)
        if exponent is not None:
            return self._power(node, exponent)
        return compose(node, self.text_of)

    def _is_trivial(self, node: Expr) -> bool:
        """Not worth a local: a name, its components, its negative."""
        is_negative = node.op is Op.NEG and self._texts[node.args[0].id].is_name
        return is_negative or node.op is Op.SWIZZLE or self._texts[node.id].is_name

    def _is_inline(self, node: Expr) -> bool:
        return self._uses[node.id] == 1 and not self._texts[node.id].is_name

    def _worst_argument(self, node: Expr, by_depth: bool) -> Expr | None:
        """The argument to make a local so that the node gets shorter: no name, no number; a constant vector last."""

        def burden(e: Expr) -> tuple[bool, int, int]:
            text = self._texts[e.id]
            return e.op is not Op.CONST, text.depth if by_depth else 0, len(text.text)

        candidates = [a for a in operands(node) if (a.args or a.type.size > 1) and not self._texts[a.id].is_name]
        return max(candidates, key=burden, default=None)

    def _declare(self, node: Expr) -> None:
        self._texts[node.id] = Text(self._local(node, self._texts[node.id].text), is_name=True)

    def _gather(self, vector: Expr) -> None:
        """A local of the vector; its components are that one's. Where it gets too long, a local of each."""
        text = self._composed(vector)
        if len(text.text) > WIDTH or text.depth > DEPTH:
            for component in vector.args:
                self._declare(component)
            return
        self._texts[vector.id] = text
        self._declare(vector)
        name = self._texts[vector.id].text
        for component, letter in zip(vector.args, "xyzw", strict=False):
            self._texts[component.id] = Text(f"{name}.{letter}", is_name=True)

    def _local(self, node: Expr, text: str) -> str:
        name = self._scope.fresh(self._called.get(node) or local_name(node))
        self.lines.append(f"{type_name(node.type)} {name} = {text};")
        return name

    def _update(self, node: Expr) -> None:
        """One step of a chain of min and max: its variable is declared by the first, updated by the others."""
        before = self._spine[node.id]
        if before is None:
            self._declare(node)
        else:
            variable = self._texts[before.id]
            self.lines.append(f"{variable.text} = {self._texts[node.id].text};")
            self._texts[node.id] = variable

    def _power(self, node: Expr, exponent: int) -> Text:
        """An integer power, which GLSL's pow does not know for a negative base."""
        base = node.args[0]
        if not self._texts[base.id].is_name:
            self._declare(base)
        name = self._texts[base.id].text
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
                key = (base.id, power)
                if key not in self._squares:
                    self._squares[key] = self._scope.fresh(f"square_{power}")
                    self.lines.append(f"{type_name(base.type)} {self._squares[key]} = {name} * {name};")
                name = self._squares[key]
        return factors


def _given_text(given: str) -> Text:
    """A text from outside: a name, a call of plain arguments, or anything, which then needs brackets."""
    if re.fullmatch(r"[A-Za-z_][\w.]*", given):
        return Text(given, is_name=True)
    return Text(given, Level.ATOM if re.fullmatch(r"\w+\([^()]*\)", given) else Level.CHOICE)


def _count_uses(order: Sequence[Expr], roots: Sequence[Expr]) -> dict[int, int]:
    """How often each node's text will be written. A swizzle is as good as its vector, so it counts as uses of that."""
    uses = dict.fromkeys((node.id for node in order), 0)
    for root in roots:
        uses[root.id] += 1
    for node in reversed(order):
        for argument in operands(node) if node.op is Op.VECTOR else node.args:
            if argument.id in uses:
                uses[argument.id] += uses[node.id] if node.op is Op.SWIZZLE else 1
    return uses


def _spines(order: Sequence[Expr], uses: dict[int, int], named: dict[int, Text]) -> dict[int, Expr | None]:
    """For each step of a long chain of min and max, the step before it, or None for the first."""
    length: dict[int, int] = {}
    before: dict[int, Expr | None] = {}
    inner_steps: set[int] = set()
    for node in order:
        if node.op not in _EXTREMES or node.id in named or clamp_limits(node) is not None:
            continue
        steps = [a for a in node.args if a.id in length and uses[a.id] == 1 and a.type is node.type]
        longest = max(steps, key=lambda a: length[a.id], default=None)
        before[node.id] = longest
        length[node.id] = 1 if longest is None else 1 + length[longest.id]
        if longest is not None:
            inner_steps.add(longest.id)
    chains: dict[int, Expr | None] = {}
    for node in order:
        if length.get(node.id, 0) >= CHAIN and node.id not in inner_steps:
            step: Expr | None = node
            while step is not None:
                chains[step.id] = before[step.id]
                step = before[step.id]
    return chains


def _integer_exponent(node: Expr) -> int | None:
    """n if the node is x to the power of the constant integer n (not 0), else None."""
    if node.op is not Op.POW or not node.args[1].is_constant or node.args[0].type.size < node.args[1].type.size:
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
