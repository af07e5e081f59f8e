"""Values that a uniform decides: computed once, at the top of main (GL.md 0: uniforms read in loops are gathers)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from sdfc.field.graph import Expr, Op, topological

_CONSTANTS = frozenset({"GROW", "CUT"})  # the templates' own, where generated calls read them
_COSTLY = frozenset(
    {Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN, Op.ATAN2, Op.EXP, Op.LOG, Op.POW, Op.SQRT, Op.LENGTH, Op.DIV}
    | {Op.MOD, Op.SELECT}
)


class Values(Protocol):
    """What is known of values where a body is written."""

    def __call__(self, expr: Expr) -> str | None:
        """The name of what holds the value, or None."""

    def is_shared(self, expr: Expr) -> bool:
        """Whether it is to be a local of the body, for all that follows."""


class Done:
    """Values that are there: names by their expressions' ids."""

    def __init__(self, names: Mapping[int, str]) -> None:
        self._names = names

    def __call__(self, expr: Expr) -> str | None:
        return self._names.get(expr.id)

    def is_shared(self, expr: Expr) -> bool:
        return False


class Live:
    """Names for expressions over params alone. The params themselves are globals too, copied from their uniforms."""

    def __init__(self, hoists: bool = True) -> None:
        self.hoists = hoists  # not where there is no main to begin with: then they are locals of the functions
        self._names: dict[int, str] = {}
        self._kind: dict[int, bool] = {}
        self.values: list[tuple[str, Expr]] = []

    def __call__(self, expr: Expr) -> str | None:
        """The global that holds `expr`, or None where it depends on more than params, or on none."""
        if expr.op is Op.INPUT and expr.value in _CONSTANTS:
            return str(expr.value)
        if not self.hoists or expr.op in (Op.CONST, Op.INPUT, Op.PARAM):
            return None
        if not self._is_live(expr) or not self._is_costly(expr):
            return None
        if expr.id not in self._names:
            self._names[expr.id] = f"live_{len(self.values) + 1}"
            self.values.append((self._names[expr.id], expr))
        return self._names[expr.id]

    def is_shared(self, expr: Expr) -> bool:
        """See Values: without a main, the sine of a param is taken once in a function, not once for each part."""
        return not self.hoists and expr.op in _COSTLY and self._is_live(expr)

    def _is_costly(self, expr: Expr) -> bool:
        """Whether a global, and the register that it keeps, is worth it: a product or a sum is not."""
        return any(node.op in _COSTLY for node in topological([expr]))

    def _is_live(self, expr: Expr) -> bool:
        if expr.id not in self._kind:
            for node in topological([expr]):
                if node.id in self._kind:
                    continue
                match node.op:
                    case Op.PARAM:
                        self._kind[node.id] = True
                    case Op.INPUT | Op.CONST:
                        self._kind[node.id] = False
                    case _:
                        constant = all(a.op is Op.CONST or self._kind[a.id] for a in node.args)
                        self._kind[node.id] = constant and any(self._kind[a.id] for a in node.args)
        return self._kind[expr.id]
