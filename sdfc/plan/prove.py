"""From a normalised shape to its step tree: closed-form interval before tangent before Lipschitz ball, leaf by leaf."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, assert_never

from sdfc.diagnostics import SceneError, scene_error
from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box, everything
from sdfc.facts.curvature import convex_shapes
from sdfc.facts.exactness import is_no_distance
from sdfc.facts.lipschitz import Lipschitz
from sdfc.facts.rule import Rule, Rules
from sdfc.field.graph import FieldGraph, Type
from sdfc.plan.drawn import drawn
from sdfc.plan.gather import gathered
from sdfc.plan.steps import (
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
    Part,
    Step,
    Tangent,
    Within,
)
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Nothing,
    Paint,
    Shape,
    Union,
    topological,
)
from sdfc.shape.lower import generic, lower_ray
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix
from sdfc.shape.stretch import largest_stretch, smallest_stretch

Rays: TypeAlias = Literal["cheap", "all"]

_OURS = frozenset(
    {"bounds", "solid", "live", "joined", "near", "far", "ahead"}
)  # generated names begin so, and end in a number

# by name: no more than there are, and the same in every scene
_STANDARD_INTERVALS: dict[str, int] = {}


@dataclass(frozen=True, slots=True)
class Leaf:
    """A leaf of a normalised shape, unwrapped: Complement, Paint and Affine are at most one each, in that order."""

    shape: Apply
    affine: Affine | None
    material: Material | None
    inside: bool
    placed: Shape  # with its Affine


def unwrapped(shape: Shape) -> Leaf | None:
    """The leaf that `shape` is, or None for a union, an intersection or Nothing."""
    inside, material, affine = True, None, None
    match shape:
        case Complement():
            inside, shape = False, shape.child
        case _:
            pass
    match shape:
        case Paint():
            material, shape = shape.material, shape.child
        case _:
            pass
    placed = shape
    match shape:
        case Affine():
            affine, shape = shape, shape.child
        case _:
            pass
    match shape:  # painted before it was placed
        case Paint():
            material, shape = material or shape.material, shape.child
        case _:
            pass
    match shape:
        case Apply():
            return Leaf(shape, affine, material, inside, placed)
        case _:
            return None


class Prover:
    """Builds the step tree of one scene.

    `rays`: which closed forms it uses, those that are dear among them or not. Without `rules` what has no closed form
    is stepped by balls.
    """

    def __init__(
        self,
        values: FieldGraph,
        bounds: Bounds,
        lipschitz: Lipschitz,
        unpainted: Material,
        rays: Rays,
        rules: Rules | None = None,
    ) -> None:
        self._values = values
        self._bounds = bounds
        self._lipschitz = lipschitz
        self._unpainted = unpainted
        self._rays = rays
        self._rules = rules
        self._names: Counter[str] = Counter()
        self._parts: dict[tuple[int, int], Part] = {}
        self._convex: frozenset[int] = frozenset()
        self._boxes = 0
        self._pieces = 0
        self._leaves: list[Leaf] = []

    @property
    def parts(self) -> tuple[Part, ...]:
        """Every part there is, in the order of the scene."""
        return tuple(self._parts.values())

    def slopes(self, needed: bool) -> dict[int, float]:
        """The Lipschitz constant of each part's formula, by its id; infinite where none is known, unless `needed`."""
        found: dict[int, float] = {}
        for leaf, part in zip(self._leaves, self.parts, strict=True):
            try:
                found[id(part)] = self._lipschitz.constant(leaf.placed, self._bounds.box(leaf.placed))
            except SceneError:
                if needed:
                    raise
                found[id(part)] = math.inf
        return found

    def prove(self, root: Shape) -> Step:
        self._convex = convex_shapes(root)
        return gathered(self._step(root, everything()))

    def _step(self, shape: Shape, domain: Box) -> Step:
        match shape:
            case Union():
                return _any([self._step(c, domain) for c in shape.children])
            case Intersection():
                inner = domain.meet(self._bounds.box(shape))
                return _all([self._step(c, inner) for c in shape.children])
            case Nothing():
                return Any(())
            case Complement(child=Nothing()):
                raise scene_error("the scene is solid everywhere", shape.span, "leave some room to look from")
            case Apply() | Affine() | Paint() | Complement():
                leaf = unwrapped(shape)
                assert leaf is not None, f"{shape} is not normalised"
                return self._leaf(leaf, domain)
            case _:
                assert_never(shape)

    def _leaf(self, leaf: Leaf, domain: Box) -> Step:
        part = self.part(leaf)
        claims = leaf.shape.definition.claims
        if claims.ray is not None and (self._rays == "all" or not claims.ray_is_dear):
            return Closed(part, self._intervals(leaf.shape), leaf.inside)
        if leaf.inside and self._is_tangent(leaf.shape):
            return Tangent(part)
        if not leaf.inside and self._is_tangent(leaf.shape) and part.box.is_finite:
            self._boxes += 1
            return Chord(part, f"bounds_{self._boxes}")
        tree = self._blend_tree(leaf) if leaf.inside else None
        own = part.box if leaf.inside else everything()
        where = own.meet(domain)
        if where.is_empty:
            return Any(()) if leaf.inside else self._ball(part, leaf, own, has_ends=False)
        ends = None if where.is_finite else self._ends(leaf, where)
        if where.is_finite:  # a little wider than the solid: its boundary belongs to it
            where = where.widened(1e-5 * max(where.radius, 1e-3))
        step: Step
        if tree is not None:
            step = Blend(part, tree, self._lipschitz.constant(leaf.placed, where))
        else:
            step = self._ball(part, leaf, where, ends is not None, is_cut=domain != everything())
        needed = not self._lipschitz.is_global(leaf.placed)
        if not where.is_finite:
            return step if ends is None else replace(self._within(ends[0], step, False), inverse=ends[1])
        boxed = leaf.inside or needed or _is_by_pieces(step)
        return self._within(where, step, needed) if boxed else step

    def _ends(self, leaf: Leaf, where: Box) -> tuple[Box, Matrix | None] | None:
        """Where a part without end has ends, a little wider; with what maps the scene to there, where it is turned."""
        far = [abs(x) for x in (*where.lo, *where.hi) if math.isfinite(x)]
        if far:
            return where.widened(1e-5 * max(1.0, *far)), None
        own = self._bounds.box(leaf.shape)
        far = [abs(x) for x in (*own.lo, *own.hi) if math.isfinite(x)]
        if not far or leaf.affine is None or not leaf.inside:
            return None
        unit = self._bounds.most(largest_stretch(leaf.affine.inverse))  # the scene's, in the part's own space
        return (own.widened(1e-5 * max(unit, *far)), leaf.affine.inverse) if math.isfinite(unit) else None

    def _ball(self, part: Part, leaf: Leaf, where: Box, has_ends: bool, is_cut: bool = True) -> Ball:
        if self._rules is None or not where.is_finite:
            lipschitz = self._lipschitz.constant(leaf.placed, where)
            # along a floor balls are the more the flatter a ray is, pieces hardly so
            is_floor = has_ends and self._rules is not None
            return self._ruled(part, lipschitz, leaf, Rule(by_pieces=is_floor, why="it has no end" if is_floor else ""))
        own = where if leaf.affine is None else self._bounds.moved(leaf.affine.inverse, where)
        lipschitz, unknown = math.inf, None
        try:
            lipschitz = self._lipschitz.constant(leaf.placed, where)
        except SceneError as error:
            unknown = error
        best = self._rules.best(leaf.shape, own, lipschitz, leaf.inside, is_cut)
        if best is None:
            raise unknown or AssertionError("there is a ball at the least")
        return self._ruled(part, lipschitz, leaf, best)

    def _ruled(self, part: Part, lipschitz: float, leaf: Leaf, rule: Rule) -> Ball:
        self._pieces += rule.by_pieces
        ahead = f"ahead_{self._pieces}" if rule.by_pieces else ""
        along = drawn(leaf.shape) if leaf.inside and rule.bend is None and not ahead else None
        return Ball(part, lipschitz, leaf.inside, rule.bend, ahead, rule.why, rule.is_core, along)

    def _within(self, box: Box, step: Step, needed: bool) -> Within:
        self._boxes += 1
        return Within(f"bounds_{self._boxes}", box, step, needed)

    def _is_tangent(self, shape: Apply) -> bool:
        claims = shape.definition.claims
        return claims.convex if shape.definition.is_primitive else shape.id in self._convex

    def _blend_tree(self, leaf: Leaf) -> BlendTree | None:
        """The operands of a smooth union in the scene's own space, or None where it is not one of leaves and unions."""
        if leaf.affine is not None or not self._is_blend(leaf.shape):
            return None
        try:
            return self._blend_of(leaf.shape, leaf)
        except SceneError:  # of an operand no Lipschitz constant is known
            return None

    def _is_blend(self, shape: Apply) -> bool:
        """Whether it is known to be a concave function of its two operands, where both are positive."""
        definition = shape.definition
        return definition.is_standard and definition.name.startswith("smooth_union") and len(shape.children) == 2

    def _blend_of(self, shape: Shape, whole: Leaf) -> BlendTree | None:
        leaf = unwrapped(shape)
        if leaf is None:
            match shape:
                case Union():
                    operands = [self._blend_of(c, whole) for c in shape.children]
                    found = [o for o in operands if o is not None]
                    return BlendUnion(tuple(found)) if len(found) == len(operands) else None
                case _:
                    return None
        if not _is_near_distance(leaf.shape):
            return None
        if leaf.inside and leaf.shape.id in self._convex:  # the formula: the blend is of formulas, not of gauges
            return Tangent(self.part(leaf))
        if leaf.inside and leaf.affine is None and self._is_blend(leaf.shape):
            first, second = (self._blend_of(c, whole) for c in leaf.shape.children)
            return None if first is None or second is None else BlendNode(leaf.shape, first, second)
        box = self._bounds.box(whole.placed)
        return Falling(self.part(leaf), self._lipschitz.throughout(leaf.placed, box), leaf.inside)

    def part(self, leaf: Leaf) -> Part:
        """The part of a leaf: one for all its uses in the tree, so that it is computed once."""
        key = (leaf.placed.id, id(leaf.material))
        if key not in self._parts:
            name = leaf.shape.definition.name
            name = f"{name}_part" if name in _OURS else name
            self._names[name] += 1
            self._leaves.append(leaf)
            self._parts[key] = self._part(leaf, f"{name}_{self._names[name]}")
        return self._parts[key]

    def _part(self, leaf: Leaf, name: str) -> Part:
        one = self._values.constant(1.0)
        inverse: Matrix | None = None
        stretch = own_grow = one
        if leaf.affine is not None:
            inverse = leaf.affine.inverse
            stretch = smallest_stretch(leaf.affine.forward)
            own_grow = largest_stretch(inverse)
        box = self._bounds.box(leaf.placed)
        looks = (leaf.material,) if leaf.material is not None else self._materials_below(leaf.shape)
        return Part(name, leaf.shape, inverse, stretch, own_grow, looks[0], looks, box, leaf.shape.span)

    def _materials_below(self, shape: Shape) -> tuple[Material, ...]:
        """Every material of an operation's parts; the unpainted one where there is an unpainted part, or no part."""
        found = {node.material: None for node in topological(shape) if isinstance(node, Paint)}
        return tuple(found) + ((self._unpainted,) if _has_bare_part(shape) or not found else ())

    def _intervals(self, shape: Apply) -> int:
        """How many intervals the primitive's ray claim gives: the same for all uses of the definition."""
        definition = shape.definition
        if not definition.is_standard:
            return self._counted(shape)
        if definition.name not in _STANDARD_INTERVALS:
            _STANDARD_INTERVALS[definition.name] = self._counted(shape)
        return _STANDARD_INTERVALS[definition.name]

    def _counted(self, shape: Apply) -> int:
        """In the form that is printed, which is remembered until then."""
        o, d, grow = self._values.input("o"), self._values.input("d"), self._values.input("grow", Type.FLOAT)
        return len(lower_ray(generic(shape, self._values), o, d, grow))


def _has_bare_part(shape: Shape) -> bool:
    """Whether one of its primitives is painted nowhere on the way down to it."""
    waiting, seen = [shape], set[int]()
    while waiting:
        node = waiting.pop()
        if node.id not in seen and not isinstance(node, Paint):
            seen.add(node.id)
            waiting += node.children
            if isinstance(node, Apply) and node.definition.is_primitive:
                return True
    return False


def _is_near_distance(shape: Apply) -> bool:
    """Whether a value of the field tells how near the surface is: a formula of an author's may be flat there."""
    own = all(node.definition.is_standard for node in topological(shape) if isinstance(node, Apply))
    return own or not is_no_distance(shape)


def _is_by_pieces(step: Step) -> bool:
    match step:
        case Ball(ahead=ahead):
            return bool(ahead)
        case _:
            return False


def _any(steps: list[Step]) -> Step:
    flat = [s for step in steps for s in (step.steps if isinstance(step, Any) else (step,))]
    return flat[0] if len(flat) == 1 else Any(tuple(flat))


def _all(steps: list[Step]) -> Step:
    if any(isinstance(s, Any) and not s.steps for s in steps):
        return Any(())
    flat = [s for step in steps for s in (step.steps if isinstance(step, All) else (step,))]
    return flat[0] if len(flat) == 1 else All(tuple(flat))
