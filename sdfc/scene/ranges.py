"""Checks of values that may depend on params: exact for a constant, at the corners of the params' ranges otherwise."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from sdfc.field.graph import Expr, Op, substitute, topological
from sdfc.scene.model import Param
from sdfc.scene.names import Context

_MOST_AT_ONCE = 2  # params whose corners are all combined: 3 values each


def samples(expr: Expr, context: Context) -> Iterator[tuple[Expr, str]]:
    """Constant values that the expression takes, each with words for where: '' or ' (at angle = 0.5)'.

    A constant is its own only sample. Otherwise every param takes its default, its low and its high, in all
    combinations for a few params, one at a time for more.
    """
    if expr.is_constant:
        yield expr, ""
        return
    used = {node: context.params[str(node.value)] for node in topological([expr]) if node.op is Op.PARAM}
    for setting in _settings(tuple(used.values())):
        context.budget.step(None)
        replace = {node: expr.graph.constant(*setting[param.name]) for node, param in used.items()}
        value = substitute(expr, replace)
        if value.is_constant:
            where = ", ".join(f"{name} = {_text(numbers)}" for name, numbers in setting.items())
            yield value, f" (at {where})"


def zero(expr: Expr, context: Context, least: float = 0.0) -> str | None:
    """Where a number is zero (or not above `least`, or no number at all), in words; None where it never is.

    A number of both signs within the params' ranges passes zero somewhere between.
    """
    signs: set[bool] = set()
    for value, where in samples(expr, context):
        if not abs(value.number) > least:
            return where
        signs.add(value.number > 0)
    return " (within the range of a param)" if len(signs) > 1 else None


def _text(numbers: tuple[float, ...]) -> str:
    text = ", ".join(f"{n:g}" for n in numbers)
    return text if len(numbers) == 1 else f"[{text}]"


def _settings(params: tuple[Param, ...]) -> Iterator[dict[str, tuple[float, ...]]]:
    defaults = {p.name: p.default for p in params}
    yield defaults
    choices = {p.name: [e for e in _ends(p) if e != p.default] for p in params}
    if len(params) <= _MOST_AT_ONCE:
        for values in product(*[[p.default, *choices[p.name]] for p in params]):
            setting = dict(zip(defaults, values, strict=True))
            if setting != defaults:
                yield setting
        return
    for name, ends in choices.items():
        for end in ends:
            yield {**defaults, name: end}


def _ends(param: Param) -> list[tuple[float, ...]]:
    return [tuple([end] * len(param.default)) for end in (param.low, param.high) if end is not None]
