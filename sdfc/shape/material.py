"""A surface's look: the metallic-roughness model, in linear colour."""

from dataclasses import dataclass

from sdfc.diagnostics import Span
from sdfc.field.graph import Expr


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """A named material; every value is an expression over constants and params. Colours are linear RGB (VEC3)."""

    name: str
    color: Expr
    metallic: Expr
    roughness: Expr
    emission: Expr
    transmission: Expr
    ior: Expr
    tint: Expr
    span: Span | None = None
