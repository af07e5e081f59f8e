"""Numbers and colours of a scene's text that are to be live although nobody declared a param: those being edited."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from sdfc.field.graph import Expr, Type
from sdfc.scene.model import Param
from sdfc.scene.values import Unit

if TYPE_CHECKING:
    from sdfc.scene.names import Context
    from sdfc.syntax import tree

Place: TypeAlias = tuple[str, int]
"""Where a literal begins: the name of its source, and the offset."""


@dataclass(frozen=True, slots=True)
class LiveLiteral:
    """A literal that is compiled like a param of this name and range (radians for an angle, linear for a colour)."""

    name: str
    low: float
    high: float


Literals: TypeAlias = Mapping[Place, LiveLiteral]
NO_LITERALS: Literals = MappingProxyType({})


def literal(node: tree.Number | tree.Color, numbers: tuple[float, ...], unit: Unit, context: Context) -> Expr | None:
    """The param that a literal is; None for most, which are constants."""
    live = context.literals.get((node.span.source.name, node.span.start)) if context.literals else None
    if live is None:
        return None
    type_ = Type(len(numbers))
    if live.name not in context.params:
        context.params[live.name] = Param(live.name, type_, numbers, live.low, live.high, unit.value, node.span)
    return context.graph.param(live.name, type_)
