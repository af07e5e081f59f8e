"""What a `.csg` file says: nested calls. Places are character offsets; the source is known to whoever reads them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from sdfc.diagnostics import Source, Span

Value: TypeAlias = "float | bool | str | tuple[Value, ...] | None"  # None is OpenSCAD's undef


@dataclass(frozen=True, slots=True, eq=False)
class Argument:
    """`name = value`, or a value alone."""

    name: str | None
    value: Value
    start: int
    end: int


_LEFT_OUT = frozenset("%*")


@dataclass(frozen=True, slots=True, eq=False)
class Call:
    """`name(arguments) { children }`, with its modifiers (`%`, `#`, `!`, `*`) in front; its place is the name's."""

    name: str
    modifiers: str
    arguments: tuple[Argument, ...] = field(repr=False)
    children: tuple[Call, ...] = field(repr=False)
    start: int
    end: int

    @property
    def shown(self) -> tuple[Call, ...]:
        """The children without those that `%` and `*` leave out."""
        return tuple([child for child in self.children if not _LEFT_OUT.intersection(child.modifiers)])

    def span(self, source: Source) -> Span:
        return Span(source, self.start, self.end)
