"""A named function over the field graph: what is printed as one GLSL function and evaluated as one NumPy call."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sdfc.field.graph import Expr, Type


@dataclass(frozen=True, slots=True)
class Function:
    """`result` in terms of INPUT nodes that have the parameters' names and types.

    `names`: what the steps on the way are called, for who reads it printed.
    """

    name: str
    parameters: tuple[tuple[str, Type], ...]
    result: Expr
    doc: str = ""
    names: Mapping[Expr, str] = field(default_factory=dict)
