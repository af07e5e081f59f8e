"""What a primitive or a distance operation says about itself: parameters, formula, claims.

Definitions come from `field` declarations, the standard library's and a user's alike: one formula, many meanings.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from types import MappingProxyType
from typing import TypeAlias

from sdfc.diagnostics import Span
from sdfc.field.graph import Expr, Type

Argument: TypeAlias = "Expr | tuple[Expr, ...]"  # a value, or a list of values (the corners of a polygon)
Environment: TypeAlias = Mapping[str, Argument]


class Kind(Enum):
    """What a parameter takes."""

    NUMBER = "number"
    LENGTH = "length"
    ANGLE = "angle"
    COUNT = "count"  # a whole number
    BOOLEAN = "boolean"
    VECTOR2 = "vector2"
    VECTOR3 = "vector3"
    POINT2 = "point2"  # a vector of lengths
    POINT3 = "point3"
    NUMBERS = "numbers"  # lists
    POINTS2 = "points2"
    POINTS3 = "points3"
    SOLID = "solid"  # a child in space
    PROFILE = "profile"  # a child in the plane

    @property
    def is_child(self) -> bool:
        return self in (Kind.SOLID, Kind.PROFILE)

    @property
    def is_list(self) -> bool:
        return self in (Kind.NUMBERS, Kind.POINTS2, Kind.POINTS3)

    @property
    def is_length(self) -> bool:
        """Whether values scale with the scene."""
        return self in (Kind.LENGTH, Kind.POINT2, Kind.POINT3, Kind.POINTS2, Kind.POINTS3)


class Exactness(Enum):
    """How a field relates to the distance (ALGORITHMS C1)."""

    EXACT = "exact"
    EXACT_OUTSIDE = "exact outside"
    EXACT_INSIDE = "exact inside"
    BOUND = "bound"
    NONE = "none"  # not a bound until divided by its Lipschitz constant


FORMAL: Mapping[Kind, Type] = MappingProxyType(
    {
        Kind.NUMBER: Type.FLOAT,
        Kind.LENGTH: Type.FLOAT,
        Kind.ANGLE: Type.FLOAT,
        Kind.VECTOR2: Type.VEC2,
        Kind.POINT2: Type.VEC2,
        Kind.VECTOR3: Type.VEC3,
        Kind.POINT3: Type.VEC3,
    }
)
"""What a parameter is as one of a function, of the kinds whose values a formula may be shared over."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a definition. `minimum` holds component by component; `above` says that it is excluded.

    One that is `found` cannot be given: it is made of the children's boxes, once they are known (passes/fence.py).
    Until then it has its default, made of boxes without end.
    """

    name: str
    kind: Kind
    default: Callable[[Environment], Argument] | None = None  # may use earlier parameters
    found: Callable[[Environment, Mapping[str, ChildFacts]], Argument] | None = None
    minimum: float | None = None
    above: bool = False
    maximum: float | None = None
    below: bool = False


@dataclass(frozen=True, slots=True)
class ChildFacts:
    """What a claim may ask of a child: its box (at the level asked for) and its Lipschitz constant."""

    lo: Expr
    hi: Expr
    lipschitz: Expr


Box: TypeAlias = tuple[Expr, Expr]
Interval: TypeAlias = tuple[Expr, Expr]
Distance: TypeAlias = Callable[[Expr], Expr]  # a child: its value at a point


@dataclass(frozen=True, slots=True)
class Claims:
    """What is claimed of a definition; each is tested for every entry of the standard library.

    For an operation, `exactness` and `convex` say what is kept of its children: EXACT keeps the child's class,
    anything else is the best class that the result can have; `convex` means convex when every child is.
    """

    exactness: Exactness = Exactness.NONE
    convex: bool = False
    # f(s p; s lengths) = s f(p; lengths): dimensionally consistent, so that a scale goes into the parameters
    homogeneous: bool = False
    # the Lipschitz constant; for an operation it may use its children's
    lipschitz: Callable[[Environment, Mapping[str, ChildFacts]], Expr] | None = None
    # the box of {f <= level} from parameters, level and the children's boxes at (level + lowering)
    bounds: Callable[[Environment, Mapping[str, ChildFacts], Expr], Box] | None = None
    # whether `bounds` used the level itself; where not, an exact-outside field's box is widened by the level
    bounds_use_level: bool = False
    # a function with the same zero set, whose {gauge <= g} is what `ray` intersects; default: the formula
    gauge: Callable[[Expr, Environment], Expr] | None = None
    # the parameter intervals where the line o + t d (d of any length) is in {gauge <= grow}: (o, d, grow, environment);
    # an interval with enter >= exit is empty; several are sorted and disjoint
    ray: Callable[[Expr, Expr, Expr, Environment], tuple[Interval, ...]] | None = None
    # whether `ray` costs more than marching where every pixel runs on a CPU: the compiler's options say if it is used
    ray_is_dear: bool = False
    # an operation's value is at least min(children) - lowering, and space is not moved
    lowering: Callable[[Environment], Expr] | None = None
    # complement(this(a, b)) = dual(complement a, complement b)
    dual: str | None = None


@dataclass(frozen=True, eq=False)
class Definition:
    """One `field` declaration. Identity is equality: a scene uses one object for one declaration.

    `formula(p, environment, children)`: the value at the point `p` (VEC3, or VEC2 in the plane); `children` maps each
    SOLID or PROFILE parameter to a function from a point to the child's value there.
    """

    name: str
    doc: str
    dimension: int  # 3 in space, 2 in the plane: of the point p
    parameters: tuple[Parameter, ...]
    formula: Callable[[Expr, Environment, Mapping[str, Distance]], Expr]
    claims: Claims
    span: Span
    is_standard: bool = False
    # (condition, message): the condition over the parameters must hold
    requirements: tuple[tuple[Callable[[Environment], Expr], str], ...] = field(default=())

    @cached_property
    def children(self) -> tuple[Parameter, ...]:
        return tuple([p for p in self.parameters if p.kind.is_child])

    @cached_property
    def values(self) -> tuple[Parameter, ...]:
        return tuple([p for p in self.parameters if not p.kind.is_child])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the values."""
        return tuple([p.name for p in self.values])

    @cached_property
    def asks_for_boxes(self) -> bool:
        """Whether a value is found from the children's boxes."""
        return any(p.found is not None for p in self.values)

    @property
    def is_primitive(self) -> bool:
        return not self.children
