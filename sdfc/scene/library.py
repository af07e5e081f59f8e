"""The standard library: `field` declarations in sdfc/std/*.sdf, each parsed when it is first asked for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import cast

from sdfc import packaged
from sdfc.diagnostics import InternalError, Source, Span
from sdfc.field.graph import Expr, FieldGraph
from sdfc.scene.check import has_sizes, try_out
from sdfc.scene.define import IN_PLANE, define, in_plane
from sdfc.scene.formula import Helper, Outer
from sdfc.shape.definition import Definition
from sdfc.syntax import tree

_DECLARATION = re.compile(r"^(field|def)[ \t]+([A-Za-z_][A-Za-z_0-9]*)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where in a library file one declaration stands."""

    source: Source
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class _Contents:
    """All declarations by name; functions also by file, since two files may use one name."""

    fields: Mapping[str, _Place]
    functions: Mapping[tuple[str, str], _Place]


class Library:
    """The standard definitions of one compilation: one object for one name."""

    def __init__(self, values: FieldGraph) -> None:
        self._values = values
        self._definitions: dict[str, Definition] = {}

    def definition(self, name: str) -> Definition | None:
        """The standard field of that name; with IN_PLANE behind it, an operation's twin for shapes in the plane."""
        made = self._definitions.get(name)
        place = _contents().fields.get(name.removesuffix(IN_PLANE))
        if made is None and place is not None:
            made = self._definitions[name] = self._made(name, _File(place.source.name))
        return made

    def _made(self, name: str, outer: Outer) -> Definition:
        if not name.endswith(IN_PLANE):
            return define(declaration(name), self._values, outer, is_standard=True)
        twin = define(in_plane(declaration(name.removesuffix(IN_PLANE))), self._values, outer, is_standard=True)
        if not has_sizes(twin):
            try_out(twin, self._values)
        return twin


@dataclass(frozen=True, slots=True)
class _File:
    """What the formulas of one library file see: the functions of that file."""

    name: str

    def value(self, name: str, span: Span) -> Expr | None:
        return None

    def function(self, name: str) -> Helper | None:
        declared = _function(self.name, name)
        return None if declared is None else Helper(declared, self)

    def names(self) -> Sequence[str]:
        return [function for file, function in _contents().functions if file == self.name]

    def literal(self, node: tree.Number, number: float) -> Expr | None:
        return None

    def step(self, span: Span) -> None:
        return None


def standard_names() -> tuple[str, ...]:
    """The name of every standard field, sorted."""
    return tuple(sorted(_contents().fields))


def standard(name: str, values: FieldGraph) -> Definition:
    """The standard field `name`. A name that there is not is a bug of the caller."""
    made = Library(values).definition(name)
    if made is None:
        raise InternalError(f"the standard library has no '{name}'")
    return made


@cache
def declaration(name: str) -> tree.FieldDeclaration:
    """The syntax tree of a standard field."""
    return cast("tree.FieldDeclaration", _parsed(_contents().fields[name]))


@cache
def _function(file: str, name: str) -> tree.FunctionDeclaration | None:
    place = _contents().functions.get((file, name))
    return None if place is None else cast("tree.FunctionDeclaration", _parsed(place))


def _parsed(place: _Place) -> tree.Statement:
    from sdfc.syntax.parse import parse_part

    (statement,) = parse_part(place.source, place.start, place.end)
    return statement


@cache
def _contents() -> _Contents:
    """Found by their first words alone: a declaration ends where the next begins."""
    fields: dict[str, _Place] = {}
    functions: dict[tuple[str, str], _Place] = {}
    for entry in sorted(packaged.folder("sdfc.std").glob("*.sdf")):
        source = Source(f"std/{entry.name}", entry.read_text(encoding="utf-8"))
        found = list(_DECLARATION.finditer(source.text))
        ends = [match.start() for match in found[1:]] + [len(source.text)]
        for match, end in zip(found, ends, strict=True):
            word, name = match.groups()
            place = _Place(source, match.start(), end)
            if word == "def":
                functions[source.name, name] = place
            elif name in fields:
                raise InternalError(f"two standard fields are called '{name}'")
            else:
                fields[name] = place
    return _Contents(MappingProxyType(fields), MappingProxyType(functions))
