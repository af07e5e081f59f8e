"""Solids that only touch have nothing in common: what an intersection asks of its parts besides their intervals.

Solids are grown a little, so that parts of a union that touch leave no crack. Two that touch then share a sheet, and a
ray that runs along the sheet a run of any length. So of an intersection's parts all but one must hold the ray by their
cores too, which are smaller than the solids by more than both are grown: the cores of two that touch are clear of each
other's skin at every angle. One may be without: a ray in the very seam of a part and its neighbour is in no core of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

from sdfc.facts.box import everything
from sdfc.field.graph import Expr
from sdfc.plan.steps import All, Closed, Part, Step, leaves_of
from sdfc.shape.lower import lower
from sdfc.shape.stretch import smallest_stretch

_THICK = 1.0 / 64.0  # in units of the scene's radius; skins lengthen what is so thick by no more than 64 of them

_EVEN = 1.5  # cores are smaller by four skins: room enough for one that is so much thicker


class Side(Enum):
    """Which of a primitive's intervals along a ray: the value is the suffix of their name."""

    WHOLE = ""  # the solid, a little larger
    CORE = "_core"  # the solid, smaller by more than that
    CUT = "_cut"  # what is taken away, larger by more than that


def is_grown(step: Step) -> bool:
    """Whether some part below is a solid whose intervals are grown; what is marched is sunk in an intersection."""
    return any(isinstance(leaf, Closed) and leaf.inside for leaf in leaves_of(step))


def thickest_skin(step: All) -> Expr | None:
    """How many times as thick as it was asked for the skin of a part may be, or None for once.

    A part that is stretched unevenly grows by all that was asked for where it is stretched least, by more elsewhere.
    """
    thickest: Expr | None = None
    for leaf in leaves_of(step):
        if isinstance(leaf, Closed) and leaf.inside and leaf.part.inverse is not None:
            times = leaf.part.own_grow / smallest_stretch(leaf.part.inverse)
            if not (times.is_constant and times.number < _EVEN):
                thickest = times if thickest is None else times.graph.max(thickest, times)
    return thickest


def convex_of(steps: Sequence[Step]) -> list[Closed]:
    """The steps that are convex solids with a closed form."""
    return [s for s in steps if isinstance(s, Closed) and s.inside and s.intervals == 1]


def are_thick_together(parts: Sequence[Part]) -> bool:
    """Whether convex parts are known to share a ball: then they do not merely touch, and need no cores.

    The middle of the box that they share is tried, at constant places and sizes only. A standard primitive's formula
    is at most the distance, so that a ball as large as its depth lies in it.
    """
    box = everything()
    for part in parts:
        box = box.meet(part.box)
    if box.is_empty or not box.is_finite or not all(part.shape.definition.is_standard for part in parts):
        return False
    middle = parts[0].stretch.graph.constant(*box.centre)
    depths = [-part.stretch * lower(part.shape, _own(part, middle)) for part in parts]
    return all(depth.is_constant and depth.number >= _THICK for depth in depths)


def _own(part: Part, p: Expr) -> Expr:
    return p if part.inverse is None else part.inverse.apply(p)
