"""A named function over the field graph: what is printed as one GLSL function and evaluated as one NumPy call."""

from dataclasses import dataclass

from sdfc.field.graph import Expr, Type


@dataclass(frozen=True, slots=True)
class Function:
    """`result` in terms of INPUT nodes that have the parameters' names and types."""

    name: str
    parameters: tuple[tuple[str, Type], ...]
    result: Expr
    doc: str = ""
