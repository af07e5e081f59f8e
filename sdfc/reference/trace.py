"""The step tree over bundles of rays, in float64: the twin of the `proven` tracer's GLSL (ALGORITHMS B0, B1)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sdfc.facts.box import Box, everything, nothing
from sdfc.field.core import DEEP
from sdfc.field.graph import Expr
from sdfc.field.piece import SHORT, look
from sdfc.plan.plan import FINE, Plan
from sdfc.plan.steps import (
    All,
    Any,
    Ball,
    Blend,
    Chord,
    Closed,
    Many,
    Part,
    Step,
    Tangent,
    Within,
    is_closed,
)
from sdfc.plan.touch import Side, are_thick_together, convex_of, is_grown, thickest_skin
from sdfc.reference.formulas import Formulas, Interval, first_inside, first_outside
from sdfc.reference.rays import Rays, box_interval
from sdfc.shape.lower import FAR
from sdfc.shape.matrix import Matrix

Array = NDArray[np.float64]

GROW = 1e-12  # solids are this much larger, so that parts that touch leave no crack; in units of the scene's radius
CUT = 4e-12  # what is cut away is this much larger, so that faces that coincide leave no film
_SIZES = {Side.WHOLE: GROW, Side.CORE: -CUT, Side.CUT: CUT}
SHY = 1.0 - 1e-12  # a step stays this much short of what is proved, for the rounding of the proof
MARGIN = 1e-6  # boxes are this much larger than what they hold
MOST_STEPS = 4096
PROVEN_TOLERANCE = FINE
"""How near counts as there, in half pixels ..."""
SMALLEST_TOLERANCE = 2.0**-22
"""... but not nearer than this, in units of the scene's radius; what converges fast is asked for this everywhere."""


@dataclass(frozen=True, slots=True)
class _Walk:
    """What is known of some rays before the first step."""

    rays: Rays
    intervals: dict[tuple[int, Side, float], list[Interval]]
    boxes: dict[int, tuple[Array, Array]]
    ahead: dict[str, Array]  # how far to look, by the name of what remembers it


@dataclass(frozen=True, slots=True)
class _Mode:
    """How a step is asked.

    Inside an intersection (`cut`) what is marched is sunk a little: by more than a film is thick that faces leave
    which coincide. In a `core`, so is what is solved in closed form, by `skin` times as much (sdfc/plan/touch).
    """

    cut: bool = False
    core: bool = False
    skin: float = 1.0
    box: int | None = None  # what the step lies within, by id


@dataclass(frozen=True, slots=True)
class _Place:
    """Where the rays numbered `index` of a walk are."""

    rays: Rays
    t: Array
    index: NDArray[np.int64]

    def take(self, chosen: NDArray[np.int64]) -> _Place:
        return _Place(self.rays.take(chosen), self.t[chosen], self.index[chosen])


class StepTracer:
    """Finds first hits. Every member of the scene's union is asked by itself, and only the rays that meet its box."""

    def __init__(self, plan: Plan, formulas: Formulas) -> None:
        self._formulas = formulas
        self._thick: dict[int, bool] = {}
        self._skins: dict[int, float] = {}
        boxed = [(member, box_of(member)) for member in members_of(plan.root)]
        self._members = [(member, box) for member, box in boxed if not box.is_empty]

    def first(self, rays: Rays, start: Array, limit: Array) -> tuple[Array, Array]:
        """The first hit at or after `start` and before `limit`, else FAR; and how many steps it took, (n,) each."""
        found = limit.copy()
        steps = np.zeros(len(rays))
        for member, box in self._members:
            enter, leave = box_interval(rays, box)
            near = np.flatnonzero((enter <= leave) & (leave >= start) & (enter < found))
            if near.size:
                begin = np.maximum(start[near], enter[near])
                t, count = self._solve(member, rays.take(near), begin, found[near])
                found[near] = np.minimum(found[near], t)
                steps[near] += count
        return np.where(found < limit, found, FAR), steps

    def tolerance(self, rays: Rays, t: Array) -> Array:
        """How near counts as there, (n,): a small part of a pixel."""
        return np.maximum(finest(t), PROVEN_TOLERANCE * rays.half_pixel(t))

    def _solve(self, member: Step, rays: Rays, start: Array, limit: Array) -> tuple[Array, Array]:
        """Steps until the tree answers where the ray is, or past the limit; only rays still on their way."""
        walk = self._walk(member, rays)
        closed = is_closed(member)
        t = self._start(member, walk, start)
        counts = np.zeros(len(rays))
        here = _Place(rays, t, np.arange(len(rays)))
        here = here.take(np.flatnonzero(t < limit))
        for _ in range(MOST_STEPS):
            if not here.index.size:
                break
            answer = self._next(member, walk, here, _Mode())
            counts[here.index] += 1.0
            t[here.index] = answer
            going = np.flatnonzero((answer > here.t) & (answer < limit[here.index]))
            here = _Place(here.rays.take(going), answer[going], here.index[going])
        if closed:
            t[here.index] = FAR  # not one solid thicker than rounding in all these events
        elif here.index.size:  # at the limit of steps a hit is what converges: nearer than the pixel is wide
            ahead = self._next(member, walk, here, _Mode()) - here.t
            t[here.index[ahead > here.rays.half_pixel(here.t)]] = FAR
        return np.where(t < limit, t, FAR), counts

    def _walk(self, member: Step, rays: Rays) -> _Walk:
        boxes = {}
        for step, box, inverse in _boxes_below(member):
            o, d = (rays.o, rays.d) if inverse is None else self._formulas.moved(inverse, rays.o, rays.d)
            boxes[id(step)] = box_interval(replace(rays, o=o, d=d), box)
        return _Walk(rays, {}, boxes, {})

    def _intervals(self, leaf: Closed, walk: _Walk, mode: _Mode) -> list[Interval]:
        """The rays' intervals with a leaf, found when they are first asked for."""
        side = Side.CUT if not leaf.inside else Side.CORE if mode.core else Side.WHOLE
        skin = 1.0 if side is Side.WHOLE else mode.skin
        key = id(leaf.part), side, skin
        if key not in walk.intervals:
            walk.intervals[key] = self._formulas.intervals(leaf.part, walk.rays.o, walk.rays.d, skin * _SIZES[side])
        return walk.intervals[key]

    def _start(self, step: Step, walk: _Walk, start: Array) -> Array:
        """Where stepping may begin: what boxes and closed-form parts prove before any value is known."""
        match step:
            case Closed(inside=True):
                return first_inside(self._intervals(step, walk, _Mode()), start)
            case Within():
                enter, leave = walk.boxes[id(step)]
                return first_inside([Interval(enter, leave)], start)
            case Any() | Many() if members_of(step):
                return _least([self._start(s, walk, start) for s in members_of(step)])
            case All() if step.steps:
                return _greatest([self._start(s, walk, start) for s in step.steps])
            case _:
                return start.copy()

    def _next(self, step: Step, walk: _Walk, here: _Place, mode: _Mode) -> Array:
        """The answers of a step, (n,)."""
        match step:
            case Closed():
                intervals = self._intervals(step, walk, mode)
                taken = [Interval(i.enter[here.index], i.leave[here.index]) for i in intervals]
                return first_inside(taken, here.t) if step.inside else first_outside(taken, here.t)
            case Tangent():
                return self._tangent(step.part, here, mode.cut)
            case Chord():
                return self._chord(step, walk, here)
            case Ball() if step.ahead:
                return self._piece(step, walk, here, mode)
            case Ball():
                return self._ball(step, here, mode.cut)
            case Blend():
                return self._blend(step, here, mode.cut)
            case Within():
                return self._within(step, walk, here, mode)
            case Any() | Many():
                answers = [self._next(s, walk, here, mode) for s in members_of(step)]
                return _least(answers) if answers else np.full(len(here.t), FAR)
            case All():
                return self._all(step, walk, here, _Mode(True, mode.core, self._skin(step), mode.box))
            case _:
                assert_never(step)

    def _all(self, step: All, walk: _Walk, here: _Place, mode: _Mode) -> Array:
        """The greatest answer; where one part already answers further on, the dearer ones are not asked."""
        grown = [s for s in step.steps if is_grown(s)]
        met = not mode.core and self._may_touch(step, grown)
        answer = self._met(grown, walk, here, mode) if met else here.t.copy()
        undecided = np.flatnonzero(answer <= here.t)
        rest = [s for s in step.steps if not (met and is_grown(s))]
        for part in sorted(rest, key=lambda s: not is_closed(s)):
            if not undecided.size:
                break
            asked = here if undecided.size == len(here.t) else here.take(undecided)
            answer[undecided] = np.maximum(answer[undecided], self._next(part, walk, asked, mode))
            undecided = np.flatnonzero(answer <= here.t)
        return answer

    def _skin(self, step: All) -> float:
        """How many times as thick as it was asked for the skin of a part may be."""
        if id(step) not in self._skins:
            skin = thickest_skin(step)
            self._skins[id(step)] = 1.0 if skin is None else float(self._formulas.constant(skin)[0])
        return self._skins[id(step)]

    def _may_touch(self, step: All, grown: list[Step]) -> bool:
        """Whether the parts that are grown may have no more than a face in common."""
        if id(step) not in self._thick:
            convex = convex_of(grown)
            alone = len(convex) == len(grown)
            self._thick[id(step)] = len(grown) < 2 or (alone and are_thick_together([s.part for s in convex]))
        return not self._thick[id(step)]

    def _met(self, grown: list[Step], walk: _Walk, here: _Place, mode: _Mode) -> Array:
        """What is in all, and but for one of them in their cores: the least of the greatest, part by part."""
        wholes, cores = ([self._next(s, walk, here, m) for s in grown] for m in (mode, replace(mode, core=True)))
        met, core = wholes[0], cores[0]
        for whole, other in zip(wholes[1:], cores[1:], strict=True):
            met = np.minimum(np.maximum(met, other), np.maximum(core, whole))
            core = np.maximum(core, other)
        return met

    def _within(self, step: Within, walk: _Walk, here: _Place, mode: _Mode) -> Array:
        enter, leave = (end[here.index] for end in walk.boxes[id(step)])
        answer = np.where((here.t < enter) & (enter < leave), enter, FAR)
        inside = np.flatnonzero((here.t >= enter) & (here.t < leave))
        if inside.size:
            ahead = self._next(step.step, walk, here.take(inside), replace(mode, box=id(step)))
            answer[inside] = np.where(ahead < leave[inside], ahead, FAR)
        return answer

    def _tangent(self, part: Part, here: _Place, cut: bool) -> Array:
        """The root of a convex function's tangent: never past the surface."""
        value, slope = self._formulas.slope(part, here.rays.at(here.t), here.rays.d)
        near = finest(here.t)
        value = value + 3.0 * near if cut else value
        fall = 1e-12 - slope
        ahead = here.t + (value - 0.5 * near) / np.where(fall > 0.0, fall, 1.0) * SHY
        return np.where(value <= near, here.t, np.where(fall > 0.0, ahead, FAR))

    def _chord(self, step: Chord, walk: _Walk, here: _Place) -> Array:
        """Out of a convex function from within: clear up to where the chord of its (concave) depth ends.

        The chord is half as long next time where that is little: along a wall chords alone would creep.
        """
        _, box_end = walk.boxes[id(step)]
        near = finest(here.t)
        most = walk.ahead.setdefault(step.name, np.full(len(walk.rays), FAR))
        value, slope = self._formulas.slope(step.part, here.rays.at(here.t), here.rays.d)
        depth = 3.0 * near - value
        tangent = np.where(slope > 1e-6, depth / np.where(slope > 1e-6, slope, 1.0), FAR)
        reach = np.minimum(tangent, most[here.index])
        reach = np.clip(reach, 0.0, np.maximum(box_end[here.index] - here.t, 0.0))
        value_there, _ = self._formulas.slope(step.part, here.rays.at(here.t + reach), here.rays.d)
        depth_there = 3.0 * near - value_there
        clear = np.where(depth_there > 0.0, reach, reach * depth / np.maximum(depth - depth_there, 1e-30))
        shorter = np.where(clear < 0.5 * reach, 0.5 * reach, 2.0 * np.maximum(clear, near))
        most[here.index] = np.where(depth <= near, FAR, shorter)
        return np.where(depth <= near, here.t, here.t + np.maximum(clear, 0.5 * near) * SHY)

    def _ball(self, step: Ball, here: _Place, cut: bool) -> Array:
        """The empty ball around the point."""
        near = finest(here.t) if cut else self.tolerance(here.rays, here.t)
        if step.bend is not None:
            return self._parabola(step, step.bend, here, cut, near)
        radius = self._formulas.value(step.part, here.rays.at(here.t)) / max(step.lipschitz, 1e-9)
        if not step.inside:  # a hit on what is cut away lies inside it, by more than its own tolerance
            radius = 3.0 * near - radius
        elif cut:
            radius = radius + 3.0 * near
        clear = radius
        if step.drawn is not None:
            beside, across = self._formulas.across(step.part, step.drawn, here.rays.at(here.t), here.rays.d)
            clear = np.where(beside * step.scale < -4.0 * near, radius / (across + 1e-12), radius)
        return np.where(radius <= near, here.t, here.t + clear * SHY)

    def _parabola(self, step: Ball, known: Expr, here: _Place, cut: bool, near: Array) -> Array:
        """To the root of the parabola below the field's core, or by the empty ball where that is more."""
        bend = max(self._formulas.bend(step.part, known), 1e-6)
        value, core, slope = self._formulas.parabola(step.part, here.rays.at(here.t), here.rays.d)
        radius = value / max(step.lipschitz, 1e-9)
        if cut:  # next to the face, and in the layer by which it is sunk, the parabola too must come down so far
            at_face = np.where(np.abs(slope) > 1e-5, np.abs(slope), 1.0)
            per = np.where(radius != 0.0, core / np.where(radius != 0.0, radius, 1.0), at_face)
            per = np.full_like(per, max(step.lipschitz, 1e-9)) if step.is_core else per
            layer = np.minimum(2.0 * near * per, DEEP * self._formulas.constant(step.part.stretch)[0])
            core = core + np.where(radius < near, layer, 0.0)
            radius = radius + 3.0 * near
        above = np.maximum(core, 0.0)
        fall = 1e-12 - slope
        root = np.sqrt(fall * fall + 2.0 * bend * above)
        falling = fall > 0.0
        clear = np.where(falling, 2.0 * above / np.where(falling, fall + root, 1.0), (root - fall) / bend)
        ahead = np.maximum(radius, np.where(core > 0.0, clear, 0.0))
        return np.where(ahead <= near, here.t, here.t + ahead * SHY)

    def _piece(self, step: Ball, walk: _Walk, here: _Place, mode: _Mode) -> Array:
        """As far as bounds over the piece of the ray ahead prove it empty, or by the empty ball where that is more."""
        assert mode.box is not None
        near = finest(here.t) if mode.cut else self.tolerance(here.rays, here.t)
        enter, leave = (end[here.index] for end in walk.boxes[mode.box])
        remembered = walk.ahead.setdefault(step.ahead, np.full(len(walk.rays), FAR))
        length = np.where(here.t <= enter, FAR, remembered[here.index])
        length = np.maximum(np.minimum(length, leave - np.maximum(here.t, enter)), SHORT * near)
        p, d = here.rays.at(here.t), here.rays.d
        value, span = self._formulas.value(step.part, p), self._formulas.span(step.part, p, d, length)
        sunk = 3.0 * near if mode.cut else np.zeros_like(near)
        if not step.inside:  # a hit on what is cut away lies inside it, by more than its own tolerance
            low, high, fall, rise = span
            value, span, sunk = -value, (-high, -low, -rise, -fall), 3.0 * near
        clear, there, remembered[here.index] = look(length, value, span, step.lipschitz, sunk, near)
        return np.where(there, here.t, here.t + np.maximum(clear * SHY, 2.0**-52 * np.maximum(1.0, np.abs(here.t))))

    def _blend(self, step: Blend, here: _Place, cut: bool) -> Array:
        """A smooth union by empty balls: slower than by the lines below its operands, and as safe."""
        near = finest(here.t)
        value = self._formulas.value(step.part, here.rays.at(here.t)) + (3.0 * near if cut else 0.0)
        return np.where(value <= near, here.t, here.t + value / max(step.lipschitz, 1.0) * SHY)


def finest(t: Array) -> Array:
    """The least tolerance that is asked for, (n,)."""
    return SMALLEST_TOLERANCE * np.maximum(1.0, np.abs(t))


def members_of(root: Step) -> tuple[Step, ...]:
    """The members of a union; anything else is its own only member."""
    match root:
        case Any():
            return tuple(member for step in root.steps for member in members_of(step))
        case Many():
            return root.members
        case _:
            return (root,)


def box_of(step: Step) -> Box:
    """A box around the solid."""
    match step:
        case Closed() | Ball():
            return step.part.box.widened(MARGIN) if step.inside else everything()
        case Tangent() | Blend():
            return step.part.box.widened(MARGIN)
        case Chord():
            return everything()
        case Within():
            inner = box_of(step.step)
            return inner if step.inverse is not None else step.box.widened(MARGIN).meet(inner)
        case Many() | Any():
            members = members_of(step)
            box = box_of(members[0]) if members else nothing()
            for member in members[1:]:
                box = box.hull(box_of(member))
            return box
        case All():
            box = everything()
            for part in step.steps:
                box = box.meet(box_of(part))
            return box
        case _:
            assert_never(step)


def _boxes_below(step: Step) -> list[tuple[Step, Box, Matrix | None]]:
    """The boxes that steps ask about along a ray, and what maps it to where they are."""
    match step:
        case Within():
            return [(step, step.box, step.inverse), *_boxes_below(step.step)]
        case Chord():  # wider than what counts as there, or a ray along a wall would creep
            return [(step, step.part.box.widened(8.0 * SMALLEST_TOLERANCE), None)]
        case Any() | All():
            return [box for s in step.steps for box in _boxes_below(s)]
        case Closed() | Many() | Tangent() | Ball() | Blend():
            return []
        case _:
            assert_never(step)


def _least(arrays: list[Array]) -> Array:
    result: Array = np.minimum.reduce(arrays)
    return result


def _greatest(arrays: list[Array]) -> Array:
    result: Array = np.maximum.reduce(arrays)
    return result
