"""The scene as written: every name, literal and call, with its place. Nothing is resolved here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from sdfc.diagnostics import Source, Span


@dataclass(frozen=True, slots=True, eq=False)
class Identifier:
    """A name that is declared, or that says what is called or set."""

    span: Span
    text: str


# --- expressions


@dataclass(frozen=True, slots=True, eq=False)
class Number:
    """A literal; `unit` is the letters right behind it ('' for none)."""

    span: Span
    value: float
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class Color:
    """`#rgb` or `#rrggbb`; `digits` is what follows the #, unchecked."""

    span: Span
    digits: str


@dataclass(frozen=True, slots=True, eq=False)
class Text:
    """A string, without its quotes."""

    span: Span
    value: str


@dataclass(frozen=True, slots=True, eq=False)
class Name:
    """A name used as a value."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class ListLiteral:
    """`[a, b, for v in list: c]`: a vector of numbers, or a list of anything."""

    span: Span
    elements: tuple[Element, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Unary:
    """`-a`, `+a`, `~a`, `not a`."""

    span: Span
    operator: str
    operand: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Operand:
    """An operator and what stands right of it."""

    operator: str
    operator_span: Span
    value: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Operation:
    """`first op a op b …`: operators of one precedence, from the left; one flat node however long."""

    span: Span
    first: Expression
    rest: tuple[Operand, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Conditional:
    """`if condition then a else b`."""

    span: Span
    condition: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Range:
    """`low..high`."""

    span: Span
    low: Expression
    high: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Call:
    """`name(arguments) { block }`, either part left out but not both."""

    span: Span
    name: Identifier
    arguments: tuple[Argument, ...]
    block: Block | None


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """`.xy`, `.radius`."""

    span: Span
    name: Identifier


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """`.round(0.1)`."""

    span: Span
    name: Identifier
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Index:
    """`[i]`."""

    span: Span
    index: Expression


Link: TypeAlias = Member | Method | Index


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """`base.first().second()[third]`: one flat node however long."""

    span: Span
    base: Expression
    links: tuple[Link, ...]


Expression: TypeAlias = (
    Number | Color | Text | Name | ListLiteral | Unary | Operation | Conditional | Range | Call | Chain
)


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """`for variable in iterable: body`, where several values may stand."""

    span: Span
    variable: Identifier
    iterable: Expression
    body: Element


Element: TypeAlias = Expression | Loop


@dataclass(frozen=True, slots=True, eq=False)
class Argument:
    """`name: value`, or `value`."""

    span: Span
    name: Identifier | None
    value: Element


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """`{ a  b  c }`: several shapes."""

    span: Span
    elements: tuple[Element, ...]


# --- statements


@dataclass(frozen=True, slots=True, eq=False)
class Import:
    """`import "file.sdf"`."""

    span: Span
    path: Text


@dataclass(frozen=True, slots=True, eq=False)
class ParamDeclaration:
    """`param name = default in low..high`."""

    span: Span
    name: Identifier
    default: Expression
    range: Expression | None


@dataclass(frozen=True, slots=True, eq=False)
class Property:
    """`name: value` in the braces of a material, a camera, a light or a sky."""

    span: Span
    name: Identifier
    value: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Properties:
    """`{ a: 1, b: 2 }`."""

    span: Span
    entries: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MaterialDeclaration:
    """`material name { … }`."""

    span: Span
    name: Identifier
    properties: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class CameraDeclaration:
    """`camera { … }`."""

    span: Span
    properties: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LightDeclaration:
    """`light name { … }`; the name may be left out."""

    span: Span
    name: Identifier | None
    properties: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SkyDeclaration:
    """`sky { … }`."""

    span: Span
    properties: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Binding:
    """`name = value` after `where`."""

    span: Span
    name: Identifier
    value: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Where:
    """`where a = x, b = y`."""

    span: Span
    bindings: tuple[Binding, ...]


@dataclass(frozen=True, slots=True, eq=False)
class DefParameter:
    """A parameter of a `def`."""

    span: Span
    name: Identifier
    default: Expression | None


@dataclass(frozen=True, slots=True, eq=False)
class FunctionDeclaration:
    """`def name(parameters) = body where …`; without parentheses it is a constant (`parameters` is None)."""

    span: Span
    name: Identifier
    parameters: tuple[DefParameter, ...] | None
    body: Expression
    where: tuple[Binding, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Limit:
    """`> 0`, `<= 1`: a bound of a field's parameter."""

    span: Span
    operator: str
    value: Expression


@dataclass(frozen=True, slots=True, eq=False)
class FieldParameter:
    """`name: kind > low < high = default`."""

    span: Span
    name: Identifier
    kind: Identifier
    limits: tuple[Limit, ...]
    default: Expression | None


@dataclass(frozen=True, slots=True, eq=False)
class Claim:
    """What a field says of itself. `word` is the claim's; the rest as that word needs it."""

    span: Span
    word: str
    detail: str = ""  # of `exact`: inside or outside; of `ray`: dear; of `dual`: the name; of `requires`: the message
    value: Expression | None = None
    where: tuple[Binding, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class FieldDeclaration:
    """`field name(parameters) "doc" in plane = formula where … claims`."""

    span: Span
    name: Identifier
    parameters: tuple[FieldParameter, ...]
    doc: str
    place: Identifier | None  # what follows `in`
    formula: Expression
    where: tuple[Binding, ...]
    claims: tuple[Claim, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SceneDeclaration:
    """`scene { … }`."""

    span: Span
    block: Block


Statement: TypeAlias = (
    Import
    | ParamDeclaration
    | MaterialDeclaration
    | CameraDeclaration
    | LightDeclaration
    | SkyDeclaration
    | FunctionDeclaration
    | FieldDeclaration
    | SceneDeclaration
)


@dataclass(frozen=True, slots=True, eq=False)
class File:
    """A whole text."""

    source: Source
    statements: tuple[Statement, ...]
