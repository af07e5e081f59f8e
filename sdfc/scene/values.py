"""What an expression of a scene can be, and what each is called in a message."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from sdfc.diagnostics import Source, Span, scene_error
from sdfc.field.graph import Expr, Type
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.material import Material


class Unit(Enum):
    """What a number or a vector measures. Lengths have no unit of their own: they are numbers."""

    NUMBER = "number"
    ANGLE = "angle"
    COLOR = "color"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number, a vector, a colour or a boolean; an angle is in radians, a colour linear RGB."""

    expr: Expr
    unit: Unit = Unit.NUMBER


@dataclass(frozen=True, slots=True)
class ListValue:
    """Several values."""

    items: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class RangeValue:
    """`low..high`."""

    low: Quantity
    high: Quantity


@dataclass(frozen=True, slots=True)
class TextValue:
    """A path."""

    text: str


@dataclass(frozen=True, slots=True)
class Row:
    """A line of a CSV table: its cells by column, and where it stands."""

    cells: Mapping[str, str]
    source: Source
    span: Span


Value: TypeAlias = Quantity | ListValue | RangeValue | TextValue | Row | Material | Shape


def _quantity_words(value: Quantity) -> str:
    match value.expr.type, value.unit:
        case Type.BOOL, _:
            return "a boolean"
        case Type.FLOAT, Unit.ANGLE:
            return "an angle"
        case Type.FLOAT, _:
            return "a number"
        case _, Unit.COLOR:
            return "a colour"
        case type_, Unit.ANGLE:
            return f"a vector of {type_.size} angles"
        case type_, _:
            return f"a vector of {type_.size}"


def words(value: Value) -> str:
    """What a value is, for a message: 'a number', 'a shape in the plane'."""
    match value:
        case Quantity():
            return _quantity_words(value)
        case ListValue():
            return f"a list of {len(value.items)}"
        case RangeValue():
            return "a range"
        case TextValue():
            return "a string"
        case Row():
            return "a row of a table"
        case Material():
            return "a material"
        case Union() | Intersection() | Complement() | Apply() | Affine() | Paint() | Nothing():
            return "a shape in space" if value.dimension == 3 else "a shape in the plane"


def is_shape(value: Value) -> bool:
    return isinstance(value, Union | Intersection | Complement | Apply | Affine | Paint | Nothing)


def shape(value: Value, span: Span, dimension: int | None = None) -> Shape:
    """The value, which must be a shape (of that dimension)."""
    if not isinstance(value, Union | Intersection | Complement | Apply | Affine | Paint | Nothing):
        raise scene_error(f"expected a shape, not {words(value)}", span)
    if dimension == 3 and value.dimension == 2:
        raise scene_error(
            "expected a shape in space, not one in the plane", span, "make it solid first: .extrude(…) or .revolve()"
        )
    if dimension == 2 and value.dimension == 3:
        raise scene_error(
            "expected a shape in the plane, not one in space", span, "cut it first: .slice() gives a shape in the plane"
        )
    return value


def quantity(value: Value, span: Span) -> Quantity:
    """The value, which must be a number, a vector, a colour or a boolean."""
    if not isinstance(value, Quantity):
        raise scene_error(f"expected a number or a vector, not {words(value)}", span)
    return value


def boolean(value: Value, span: Span) -> Expr:
    """The value, which must be a boolean."""
    if not isinstance(value, Quantity) or value.expr.type is not Type.BOOL:
        raise scene_error(f"expected a condition, not {words(value)}", span)
    return value.expr


def number(value: Value, span: Span, what: str = "a number") -> Expr:
    """The value, which must be a number without unit."""
    if not isinstance(value, Quantity) or value.expr.type is not Type.FLOAT or value.unit is not Unit.NUMBER:
        raise scene_error(f"expected {what}, not {words(value)}", span)
    return value.expr


def angle(value: Value, span: Span) -> Expr:
    """The value, which must be an angle: a bare number is none."""
    if not isinstance(value, Quantity) or value.expr.type is not Type.FLOAT:
        raise scene_error(f"expected an angle, not {words(value)}", span)
    if value.unit is not Unit.ANGLE:
        hint = f"write {value.expr.number:g}deg" if value.expr.is_constant else "multiply it by 1deg or 1rad"
        raise scene_error(f"expected an angle, not {words(value)}", span, hint)
    return value.expr


def vector(value: Value, size: int, span: Span, spread: bool = False) -> Expr:
    """The value, which must be a vector of `size` numbers; with `spread`, a number is one of equal components."""
    if isinstance(value, Quantity) and value.unit is Unit.NUMBER:
        if value.expr.type is Type(size):
            return value.expr
        if spread and value.expr.type is Type.FLOAT:
            return value.expr.graph.vector(*[value.expr] * size)
    example = "[x, y]" if size == 2 else "[x, y, z]"
    raise scene_error(f"expected a vector {example}, not {words(value)}", span)


def color(value: Value, span: Span) -> Expr:
    """The value as linear RGB: a colour, or a vector of three numbers."""
    if not isinstance(value, Quantity) or value.expr.type is not Type.VEC3 or value.unit is Unit.ANGLE:
        raise scene_error(f"expected a colour, not {words(value)}", span, "write #rrggbb, or [r, g, b] (linear)")
    return value.expr


def constant(expr: Expr, what: str, span: Span) -> Expr:
    """The expression, which must not depend on a param."""
    if not expr.is_constant:
        raise scene_error(f"{what} must be known when the scene is compiled, and this depends on a param", span)
    return expr


def items(value: Value, span: Span) -> tuple[Value, ...]:
    """The elements of a list; a vector is the list of its components."""
    if isinstance(value, ListValue):
        return value.items
    if isinstance(value, Quantity) and value.expr.type.value > 1:
        return tuple([Quantity(value.expr[i], value.unit) for i in range(value.expr.type.size)])
    raise scene_error(f"expected a list, not {words(value)}", span)
