"""Where the text of a step is written, and what it finds there."""

from __future__ import annotations

from dataclasses import dataclass

from sdfc.field.graph import Expr
from sdfc.glsl.body import Body
from sdfc.plan.touch import Side


@dataclass(frozen=True, slots=True)
class Intervals:
    """The ray's intervals with closed-form parts: names by part, side and skin, declared as they are asked for."""

    body: Body
    names: dict[tuple[int, Side, int], str]


@dataclass(frozen=True, slots=True)
class Scope:
    """Where a step is written: the loop's body, the intervals and directions declared before it.

    Inside an intersection (`cut`) what is marched is sunk a little, by more than the film that coinciding faces leave,
    and asked for all the digits that float32 has. In a `core`, so is what is solved in closed form, by more where the
    intersection's skins are thicker (sdfc/plan/touch).
    """

    body: Body
    intervals: Intervals
    directions: dict[int, Expr]
    marched: dict[int, str]  # answers of what is marched, by step: asked once, also where its intersection asks twice
    cut: bool = False
    core: bool = False
    twice: bool = False
    skin: Expr | None = None
    box: str = ""  # what the step lies within, if anything
