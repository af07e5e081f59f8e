"""What is at points near the surface: gradient, value and material of the part whose surface it is; and distances.

Parts are ranked a little way back along the ray where there may be seams: the twin of sdfc/glsl/surface, which
says why.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sdfc.facts.box import Box
from sdfc.plan.plan import Plan
from sdfc.plan.steps import (
    FLATTEST,
    All,
    Any,
    Ball,
    Blend,
    BlendNode,
    BlendTree,
    BlendUnion,
    Chord,
    Closed,
    Falling,
    Many,
    Part,
    Step,
    Tangent,
    Within,
    is_closed,
    may_have_seams,
)
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import box_gap
from sdfc.reference.trace import CUT, box_of, members_of
from sdfc.shape.lower import FAR

Array = NDArray[np.float64]
_BACK = 16.0 * CUT  # so far back, in units of the scene's radius
_SUNK = 3.0  # what is marched is sunk so far in an intersection (sdfc/reference/trace)
_NEAR = 1e-2  # a point on a union's surface is no further than this from the box of the member that it is on


@dataclass(frozen=True, slots=True)
class Surface:
    """`field` (4, n): gradient and value. `material` (n,): its index in the plan. `look` (13, n): see PROPERTIES.

    `rank` (n,) is the value of what is traced, a little way back.
    """

    field: Array
    rank: Array
    material: NDArray[np.int64]
    look: Array

    def put(self, index: NDArray[np.int64], other: Surface) -> None:
        """Takes over all of `other` at `index`."""
        self.field[:, index] = other.field
        self.rank[index] = other.rank
        self.material[index] = other.material
        self.look[:, index] = other.look

    def take(self, chosen: NDArray[np.bool_] | NDArray[np.int64]) -> Surface:
        """Some of the points."""
        return Surface(self.field[:, chosen], self.rank[chosen], self.material[chosen], self.look[:, chosen])


@dataclass(frozen=True, slots=True)
class _Place:
    """Hits p (3, n), the way back (3, n) to where parts are ranked, and what hits are right to (n,)."""

    p: Array
    d: Array
    back: Array
    fine: Array

    def take(self, index: NDArray[np.int64]) -> _Place:
        return _Place(self.p[:, index], self.d[:, index], self.back[:, index], self.fine[index])


class SurfaceFold:
    """Folds a step tree at points, in the scene's own coordinates."""

    def __init__(self, plan: Plan, formulas: Formulas) -> None:
        self._plan = plan
        self._formulas = formulas
        self._index = {id(m): i for i, m in enumerate(plan.materials)}
        self._looks = np.stack([formulas.material(m) for m in plan.materials], axis=1)
        self._boxes: dict[int, Box] = {}
        self._looks_back = may_have_seams(plan.root)

    def at(self, p: Array, d: Array, fine: Array) -> Surface:
        """The surface at hits p (3, n) of rays along unit vectors d (3, n), right to `fine` (n,)."""
        back = -_BACK * d if self._looks_back else np.zeros_like(d)
        return self._fold(self._plan.root, _Place(p, d, back, fine), np.zeros_like(fine))

    def distance(self, p: Array, reach: float) -> Array:
        """What tells how open the sky is: at most the distance (n,) to what is within `reach`; the right sign."""
        return self._distance(self._plan.root, p, reach)

    # surfaces

    def _fold(self, step: Step, place: _Place, sunk: Array) -> Surface:
        match step:
            case Closed():
                return self._leaf(step.part, place, step.inside, np.zeros_like(sunk))
            case Ball():
                return self._ball(step, place, sunk)
            case Tangent():
                return self._leaf(step.part, place, True, sunk)
            case Chord():
                return self._leaf(step.part, place, False, sunk)
            case Blend():
                return self._blend(step.tree, place, sunk)
            case Within():
                return self._fold(step.step, place, sunk)
            case Any() | Many():
                return self._nearest(members_of(step), place, sunk)
            case All():
                first, *rest = (self._fold(s, place, _SUNK * place.fine) for s in step.steps)
                for other in rest:
                    farther = np.flatnonzero(other.rank > first.rank)
                    first.put(farther, other.take(farther))
                return first
            case _:
                assert_never(step)

    def _nearest(self, members: tuple[Step, ...], place: _Place, sunk: Array) -> Surface:
        """Only the members whose boxes are near are asked: a scene may have thousands."""
        result = self._empty(place.p.shape[1])
        for member in members:
            near = np.flatnonzero(box_gap(place.p, self._box(member)) < _NEAR)
            if near.size:
                found = self._fold(member, place.take(near), sunk[near])
                nearer = np.flatnonzero(found.rank < result.rank[near])
                result.put(near[nearer], found.take(nearer))
        return result

    def _leaf(
        self, part: Part, place: _Place, inside: bool, sunk: Array, formula: bool = False, scale: float = 1.0
    ) -> Surface:
        signed = scale if inside else -scale
        field = self._formulas.surface(part, place.p, formula) * signed
        before = field
        if self._looks_back:
            before = self._formulas.surface(part, place.p + place.back, formula) * signed
        if len(part.looks) > 1:
            index = self._formulas.look(part, place.p)
        else:
            index = np.full(place.p.shape[1], self._index[id(part.material)])
        return Surface(field, before[3] + sunk, index, self._looks[:, index])

    def _ball(self, step: Ball, place: _Place, sunk: Array) -> Surface:
        """Over its constant: then the gradient says how much of a distance the value is."""
        if not step.is_no_distance:
            return self._leaf(step.part, place, step.inside, sunk, scale=step.scale)
        found = self._leaf(step.part, place, step.inside, np.zeros_like(sunk), scale=step.scale)
        gradient = found.field[:3]
        depth = sunk * np.abs(np.sum(gradient * place.d, axis=0)) if step.ahead else sunk
        steepness = np.maximum(np.linalg.norm(gradient, axis=0), FLATTEST)
        return Surface(found.field, (found.rank + depth) / steepness, found.material, found.look)

    def _blend(self, tree: BlendTree, place: _Place, sunk: Array) -> Surface:
        match tree:
            case Tangent():
                return self._leaf(tree.part, place, True, sunk, formula=True)
            case Falling():
                return self._leaf(tree.part, place, tree.inside, sunk, formula=True)
            case BlendUnion():
                first, *rest = (self._blend(t, place, sunk) for t in tree.operands)
                for other in rest:
                    nearer = np.flatnonzero(other.rank < first.rank)
                    first.put(nearer, other.take(nearer))
                return first
            case BlendNode():
                first, second = (self._blend(t, place, sunk) for t in (tree.first, tree.second))
                return self._blended(tree, first, second, place, sunk)
            case _:
                assert_never(tree)

    def _blended(self, tree: BlendNode, a: Surface, b: Surface, place: _Place, sunk: Array) -> Surface:
        """Both gradients by the blend's own derivatives; the look is mixed in their proportion."""
        by_a, by_b, value = self._formulas.weights(tree.shape, a.field[3], b.field[3])
        share = by_b / np.maximum(by_a + by_b, 1e-6)
        field = np.concatenate([by_a * a.field[:3] + by_b * b.field[:3], value[None]])
        material = np.where(by_b > by_a, b.material, a.material)
        rank = value + np.sum(field[:3] * place.back, axis=0) + sunk
        return Surface(field, rank, material, a.look + (b.look - a.look) * share)

    def _empty(self, count: int) -> Surface:
        field = np.zeros((4, count))
        field[1], field[3] = 1.0, FAR
        looks = np.repeat(self._looks[:, :1], count, axis=1)
        return Surface(field, field[3].copy(), np.zeros(count, np.int64), looks)

    # distances

    def _distance(self, step: Step, p: Array, reach: float) -> Array:
        match step:
            case Closed() | Ball():
                return self._value(step.part, p, step.inside)
            case Tangent() | Blend():
                return self._value(step.part, p, True)
            case Chord():
                return self._value(step.part, p, False)
            case Within():
                inner = self._distance(step.step, p, reach)
                if not step.is_needed:
                    return inner
                # outside, the value means nothing; the box's distance, though a bound, would shade like a box
                return np.where(box_gap(p, step.box) > 0.0, FAR, inner)
            case Any() | Many():
                result = np.full(p.shape[1], FAR)
                for member in members_of(step):
                    near = self._within_reach(member, p, reach)
                    if near.size:
                        result[near] = np.minimum(result[near], self._distance(member, p[:, near], reach))
                return result
            case All():
                result = self._distance(step.steps[0], p, reach)
                for other in step.steps[1:]:
                    result = np.maximum(result, self._distance(other, p, reach))
                return result
            case _:
                assert_never(step)

    def _within_reach(self, member: Step, p: Array, reach: float) -> NDArray[np.int64]:
        """The points that `member` may be near to. Only primitives measure distances no worse than their boxes do."""
        if not is_closed(member):
            return np.arange(p.shape[1])
        return np.flatnonzero(box_gap(p, self._box(member)) < reach)

    def _value(self, part: Part, p: Array, inside: bool) -> Array:
        slope = self._plan.slopes[id(part)]
        if not math.isfinite(slope):  # no bound is known: it shades nothing around it
            return np.full(p.shape[1], FAR if inside else -FAR)
        value = self._formulas.value(part, p) / max(slope, 1e-9)
        return value if inside else -value

    def _box(self, step: Step) -> Box:
        if id(step) not in self._boxes:
            self._boxes[id(step)] = box_of(step)
        return self._boxes[id(step)]
