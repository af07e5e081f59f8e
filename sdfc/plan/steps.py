"""The step tree: for each part of a scene, the best rule that it can prove for how far a ray may go (DESIGN 2).

Every rule answers one question, `next(t)`: the first parameter at or after t where the part may be solid. It answers t
itself exactly where the ray is inside (or within tolerance of) the part. A union is the least of its parts' answers,
an intersection the greatest; a ray hits where the tree answers t, and misses where it answers FAR.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias, assert_never

from sdfc.diagnostics import Span
from sdfc.facts.box import Box
from sdfc.facts.exactness import exactness, is_no_distance
from sdfc.field.graph import Expr
from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Apply
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix

FLATTEST = 1e-6  # a gradient that is less says nothing of how far off a surface is


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A leaf of the tree, placed: what is at `inverse(p)` is `shape` (a primitive, or an operation with all below it).

    `stretch` times a value in the part's own space is a value in the scene's; `own_grow` times a length in the scene
    is at least as long in the part's own space. `box` holds the part, in the scene's coordinates.
    """

    name: str
    shape: Apply
    inverse: Matrix | None
    stretch: Expr
    own_grow: Expr
    material: Material
    looks: tuple[Material, ...]  # all that are below; more than one only in an operation
    box: Box
    span: Span


@dataclass(frozen=True, slots=True, eq=False)
class Closed:
    """A primitive whose ray intervals are known in closed form: exact events, no marching."""

    part: Part
    intervals: int
    inside: bool = True  # False: its complement


@dataclass(frozen=True, slots=True, eq=False)
class Many:
    """Members of the scene's union that are alike but for place, size and material: a row of a table each.

    All are Closed, of one definition, moved only, constant, with one interval a ray.
    """

    name: str
    members: tuple[Closed, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Tangent:
    """A convex function: the tangent's root is never past the surface (a Newton step that cannot overshoot)."""

    part: Part


@dataclass(frozen=True, slots=True, eq=False)
class Chord:
    """The complement of a convex function, which is concave: where both ends of a stretch are empty, all of it is."""

    part: Part
    name: str  # of the part's box along the ray


@dataclass(frozen=True, slots=True, eq=False)
class Ball:
    """A field known to be Lipschitz: the empty ball around the point.

    With `bend`, also the parabola below it: along a line of unit speed in the part's own space its core (facts/bend.py)
    falls no faster than f + f' x - bend x x / 2. With `ahead`, also bounds of its value and slope over the piece of the
    ray ahead: so is named how long that is, which the ray remembers. Then the constant may be infinite: no ball.

    `drawn`: nearer to z = 0 of the part's own space than so, the field outside is a profile's (sdfc/plan/drawn): it
    comes down only as a ray goes across z, and along its walls the ball is stretched.
    """

    part: Part
    lipschitz: float
    inside: bool = True
    bend: Expr | None = None
    ahead: str = ""
    why: str = ""  # this rule: what rays that were tried took by each
    is_core: bool = False  # the field is its own core: the constant times as much as the radius of the ball
    drawn: Expr | None = None

    @property
    def scale(self) -> float:
        """What makes a value at most a distance; 1 where no constant is known, and it says nothing of a distance."""
        return 1.0 / max(self.lipschitz, 1e-9) if math.isfinite(self.lipschitz) else 1.0

    @property
    def is_no_distance(self) -> bool:
        """Whether its values say nothing of how near the surface is."""
        return is_no_distance(self.part.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """A smooth union: the blend of lines that are below its operands is concave along the ray, and below the field.

    A convex function's line is its tangent; a field that is known to be Lipschitz falls no faster than its constant.
    """

    part: Part  # the whole blend
    tree: BlendTree
    lipschitz: float


@dataclass(frozen=True, slots=True, eq=False)
class BlendNode:
    """A blend operation of two operands, by its definition (`shape.children` are the operands)."""

    shape: Apply
    first: BlendTree
    second: BlendTree


@dataclass(frozen=True, slots=True, eq=False)
class BlendUnion:
    """A hard union inside a blend."""

    operands: tuple[BlendTree, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Falling:
    """An operand of a blend of which only a Lipschitz constant is known."""

    part: Part
    lipschitz: float
    inside: bool = True


BlendLeaf: TypeAlias = Tangent | Falling
BlendTree: TypeAlias = BlendLeaf | BlendNode | BlendUnion


@dataclass(frozen=True, slots=True, eq=False)
class Within:
    """`step` matters only inside a box: outside, the box's own closed-form interval says how far to go.

    The box may be without some of its sides: a floor lies below a plane. With `inverse`, it is one of the space that
    this maps the scene to: a floor that is turned.
    """

    name: str
    box: Box
    step: Step
    is_needed: bool  # whether the step's constant holds only inside: never where the box has no end
    inverse: Matrix | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Any:
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True, eq=False)
class All:
    steps: tuple[Step, ...]


Step: TypeAlias = Closed | Many | Tangent | Chord | Ball | Blend | Within | Any | All


def is_finite(step: Step) -> bool:
    """Whether all that the step may find is in a box that is known."""
    match step:
        case Closed(inside=inside) | Ball(inside=inside):
            return inside and step.part.box.is_finite
        case Tangent() | Blend():
            return step.part.box.is_finite
        case Chord():
            return False
        case Many():
            return all(is_finite(m) for m in step.members)
        case Within():
            return step.box.is_finite
        case Any():
            return all(is_finite(s) for s in step.steps)
        case All():
            return any(is_finite(s) for s in step.steps)
        case _:
            assert_never(step)


def may_flatten(step: Within) -> bool:
    """Whether what is within may know of no more than a small distance, however far away: its box knows better then."""
    match step.step:
        case Ball(part=part) if step.box.is_finite:
            return exactness(part.shape)[part.shape.id] not in (Exactness.EXACT, Exactness.EXACT_OUTSIDE)
        case _:
            return False


def may_have_seams(step: Step) -> bool:
    """Whether values at a hit may not tell whose face it is.

    It may be buried in a seam: one that cuts a part of a union, or a part that is marched. Or a value is no distance.
    """
    match step:
        case All():
            return not is_closed(step) or any(may_have_seams(s) for s in step.steps)
        case Any():
            return any(_is_cut(s) or _has_no_distance(s) or may_have_seams(s) for s in step.steps)
        case Within():
            return may_have_seams(step.step)
        case Closed() | Many() | Tangent() | Chord() | Ball() | Blend():
            return False
        case _:
            assert_never(step)


def _is_cut(step: Step) -> bool:
    match step:
        case All():
            return True
        case Within():
            return _is_cut(step.step)
        case _:
            return False


def _has_no_distance(step: Step) -> bool:
    match step:
        case Ball():
            return step.is_no_distance
        case Within():
            return _has_no_distance(step.step)
        case _:
            return False


def is_closed(step: Step) -> bool:
    """Whether the whole tree is events: solved without marching."""
    match step:
        case Closed() | Many():
            return True
        case Tangent() | Chord() | Ball() | Blend() | Within():
            return False
        case Any() | All():
            return all(is_closed(s) for s in step.steps)


Leaf: TypeAlias = Closed | Tangent | Chord | Ball | Blend


def leaves_of(step: Step) -> list[Leaf]:
    """The leaves, in order."""
    match step:
        case Closed() | Tangent() | Chord() | Ball() | Blend():
            return [step]
        case Many():
            return list(step.members)
        case Within():
            return leaves_of(step.step)
        case Any() | All():
            return [leaf for s in step.steps for leaf in leaves_of(s)]
