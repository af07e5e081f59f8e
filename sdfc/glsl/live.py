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


_CONST, _INPUT, _PARAM = Op.CONST, Op.INPUT, Op.PARAM


class Values(Protocol):
    """What is known of values where a body is written."""

    shares: bool  # whether `is_shared` may hold of anything

    def __call__(self, expr: Expr) -> str | None:
        """The name of what holds the value, or None."""

    def is_shared(self, expr: Expr) -> bool:
        """Whether it is to be a local of the body, for all that follows."""


class Done:
    """Values that are there, by name."""

    shares = False

    def __init__(self, names: Mapping[Expr, str]) -> None:
        self._names = names

    def __call__(self, expr: Expr) -> str | None:
        return self._names.get(expr)

    def is_shared(self, expr: Expr) -> bool:
        return False


class Live:
    """Names for expressions over params alone. The params themselves are globals too, copied from their uniforms."""

    def __init__(self, hoists: bool = True) -> None:
        self.shares = not hoists  # where there is no main to begin with, they are locals of the functions
        self._names: dict[Expr, str | None] = {}
        self._is_live: dict[Expr, bool] = {}
        self.values: list[tuple[str, Expr]] = []

    def __call__(self, expr: Expr) -> str | None:
        """The global that holds `expr`, or None where it depends on more than params, or on none."""
        if expr not in self._names:
            self._names[expr] = self._named(expr)
        return self._names[expr]

    def _named(self, expr: Expr) -> str | None:
        if expr.op is _INPUT and expr.value in _CONSTANTS:
            return str(expr.value)
        if self.shares or not expr.args or not self._depends_on_params(expr) or not _is_costly(expr):
            return None
        name = f"live_{len(self.values) + 1}"
        self.values.append((name, expr))
        return name

    def is_shared(self, expr: Expr) -> bool:
        """See Values: without a main, the sine of a param is taken once in a function, not once for each part."""
        return self.shares and expr.op in _COSTLY and self._depends_on_params(expr)

    def _depends_on_params(self, expr: Expr) -> bool:
        """Whether on params, and on nothing else."""
        known = self._is_live.get(expr)
        if known is None:
            known = expr.op is _PARAM
            for argument in expr.args:
                if argument.op is not _CONST:
                    known = self._depends_on_params(argument)
                    if not known:
                        break
            self._is_live[expr] = known
        return known


def _is_costly(expr: Expr) -> bool:
    """Whether a global, and the register that it keeps, is worth it: a product or a sum is not."""
    return any(node.op in _COSTLY for node in topological([expr]))
