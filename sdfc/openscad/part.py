"""What a call makes: something in the plane, or a solid; None stands for nothing at all."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from sdfc.openscad.generators import Span3
from sdfc.openscad.plane import Plane
from sdfc.shape.graph import Shape


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """A shape in the plane. `is_convex`: known to be its own hull."""

    plane: Plane = field(repr=False)
    is_convex: bool


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A shape in space, and what its convex hull is spanned by. `is_convex`: known to be its own hull."""

    shape: Shape = field(repr=False)
    hull: Span3 = field(repr=False)
    is_convex: bool


Part: TypeAlias = Flat | Solid
