"""The ways to trace a scene: which are legal, and how long each is predicted to take (ALGORITHMS E).

A prediction is a guide. Where two are close, a small pilot on the device decides (sdfc.api.choose).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import assert_never

from sdfc.facts.cost import cost
from sdfc.facts.exactness import is_no_distance
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.plan.cluster import CLUSTER
from sdfc.plan.plan import FINE, Plan
from sdfc.plan.steps import (
    Any,
    Ball,
    Blend,
    Chord,
    Closed,
    Leaf,
    Many,
    Part,
    Step,
    Tangent,
    is_closed,
    leaves_of,
)
from sdfc.shape.definition import Kind
from sdfc.shape.lower import Lowering, lower_ray
from sdfc.tracers import TRACERS

CLOSE = 1.5  # predictions within this factor do not decide

_PIXEL = 1e-3  # half a pixel, in radii: what predictions are made for
# Passes of marching, by the rule of the scene's slowest part (ALGORITHMS E). Balls are few where most rays meet what is
# solved, or a box that they miss: the scenes of this repository take 2 to 11 where a scene of balls alone takes thirty.
_PASSES = {"closed": 1.0, "tangent": 3.5, "chord": 4.5, "blend": 8.0, "slope": 6.0, "ball": 8.0}
_DUAL = 1.85  # what a value with its slope costs, in values: measured 1.73 to 1.86 (ALGORITHMS E)
_PIECE = 5.0  # what a value with bounds over a piece of the ray costs, in values: measured 2.5 to 6
_OWN = frozenset({Kind.COUNT, Kind.NUMBERS, Kind.POINTS2, Kind.POINTS3})  # values that shape the formula itself
# time with the cone prepass, of that without: it saves marchers half, and `proven`, which passes empty space in a step
# or two, next to nothing (on ten scenes 0.8 to 1.8, most of them above 1)
_SWEPT_MARCHER, _SWEPT_PROVEN = 0.6, 1.05


@dataclass(frozen=True, slots=True)
class Speeds:
    """What a device takes, in nanoseconds a pixel: a frame's own, an addition of a formula, a row of a table."""

    device: str
    frame: float
    addition: float
    row: float


UNMEASURED = Speeds("no device measured: llvmpipe on two cores is assumed", 4.0, 0.02, 5.0)


@dataclass(frozen=True, slots=True)
class Candidate:
    """A way to trace a scene. `milliseconds`: predicted for a million pixels, with `passes` of marching a ray."""

    tracer: str
    prepass: bool
    all_rays: bool
    milliseconds: float
    passes: float
    illegal: str = ""  # why it may not be chosen

    @property
    def name(self) -> str:
        extra = (" with the cone prepass" * self.prepass, " with every closed form" * self.all_rays)
        return "".join([self.tracer, *extra])


def candidates(plan: Plan, graph: FieldGraph, speeds: Speeds, dear: Plan | None = None) -> list[Candidate]:
    """Every way to trace a scene, the fastest first and the illegal ones last.

    `plan` is the plan with `proven`; `dear` the one with every closed form, where that makes a difference.
    """
    found = []
    for name, tracer in TRACERS.items():
        if tracer.needs_steps:
            found += [_stepped(plan, graph, speeds, prepass, False) for prepass in _choices(plan)]
            if dear is not None:
                found += [_stepped(dear, graph, speeds, prepass, True) for prepass in _choices(dear)]
        else:
            found += [_marched(name, plan, graph, speeds, prepass) for prepass in (False, True)]
    return sorted(found, key=lambda c: (bool(c.illegal), c.milliseconds))


def _choices(plan: Plan) -> tuple[bool, ...]:
    return (False, True) if plan.can_sweep else (False,)


def _stepped(plan: Plan, graph: FieldGraph, speeds: Speeds, prepass: bool, all_rays: bool) -> Candidate:
    work = _Work(graph)
    single = [leaf for step in _components(plan.root) if not isinstance(step, Many) for leaf in leaves_of(step)]
    closed = sum(work.ray(leaf.part) for leaf in single if isinstance(leaf, Closed))
    marched = [leaf for step in _components(plan.root) if not is_closed(step) for leaf in leaves_of(step)]
    passes = max((_passes(leaf) for leaf in marched), default=0.0)
    each = sum(work.step(leaf) for leaf in marched)
    if prepass:
        passes *= _SWEPT_PROVEN
    nanoseconds = speeds.frame + speeds.addition * (closed + passes * each) + speeds.row * _rows(plan)
    return Candidate(plan.tracer.name, prepass, all_rays, nanoseconds, passes)


def _marched(name: str, plan: Plan, graph: FieldGraph, speeds: Speeds, prepass: bool) -> Candidate:
    tracer = TRACERS[name]
    work = _Work(graph)
    passes = tracer.pace * _classic()
    if prepass:
        passes *= _SWEPT_MARCHER
    each = sum(work.value(leaf.part) for leaf in leaves_of(plan.root) if not _is_row(plan, leaf))
    nanoseconds = speeds.frame + passes * (speeds.addition * each * tracer.weight + speeds.row * _rows(plan))
    return Candidate(name, prepass, False, nanoseconds, passes, _objection(name, plan))


def _rows(plan: Plan) -> float:
    """Rows of tables that a ray looks at: two for every cluster of sixteen, and all of two clusters."""
    count = sum(len(step.members) for step in _components(plan.root) if isinstance(step, Many))
    return count / 8.0 + 2.0 * CLUSTER if count else 0.0


def _objection(name: str, plan: Plan) -> str:
    unbounded = [leaf.part.name for leaf in leaves_of(plan.root) if not math.isfinite(plan.slopes[id(leaf.part)])]
    if unbounded:
        return f"no Lipschitz constant is known for {', '.join(unbounded[:3])}"
    flat = [leaf.part.name for leaf in leaves_of(plan.root) if is_no_distance(leaf.part.shape)]
    if flat:
        return f"the value of {', '.join(flat[:3])} over its Lipschitz constant does not tell how near it is"
    families: dict[str, list[str]] = {}
    for family, why in TRACERS[name].weak.items():
        families.setdefault(why, []).append(family)
    return "; ".join(f"may fail at {', '.join(some)}: {why}" for why, some in families.items())


def _classic() -> float:
    """Passes of sphere tracing to the tolerance (ALGORITHMS E)."""
    return 8.0 + 2.5 * math.log(1.0 / (FINE * _PIXEL))


def _components(root: Step) -> tuple[Step, ...]:
    return root.steps if isinstance(root, Any) else (root,)


def _is_row(plan: Plan, leaf: Leaf) -> bool:
    return any(isinstance(step, Many) and leaf in step.members for step in _components(plan.root))


def _passes(leaf: Leaf) -> float:
    match leaf:
        case Closed():
            return _PASSES["closed"]
        case Tangent():
            return _PASSES["tangent"]
        case Chord():
            return _PASSES["chord"]
        case Blend():
            return _PASSES["blend"]
        case Ball():
            is_plain = leaf.bend is None and not leaf.ahead
            return _PASSES["ball" if is_plain else "slope"]
        case _:
            assert_never(leaf)


class _Work:
    """What parts cost, each formula counted once."""

    def __init__(self, graph: FieldGraph) -> None:
        self._graph = graph
        self._lowering = Lowering()
        self._p, self._o, self._d = (graph.input(name, Type.VEC3) for name in "pod")
        self._known: dict[tuple[str, int], float] = {}

    def value(self, part: Part) -> float:
        """Of the part's value at a point."""
        return self._once("value", part, lambda: [self._lowering.value(part.shape, self._p)])

    def slope(self, part: Part) -> float:
        """Of its value, and the slope along a ray."""
        return _DUAL * self.value(part)

    def ray(self, part: Part) -> float:
        """Of its closed-form intervals."""
        return self._once("ray", part, lambda: self._ends(part))

    def step(self, leaf: Leaf) -> float:
        """Of a marching step."""
        match leaf:
            case Closed():
                return 2.0
            case Tangent() | Blend():
                return self.slope(leaf.part)
            case Chord():
                return 2.0 * self.slope(leaf.part)
            case Ball():
                if leaf.ahead:
                    return _PIECE * self.value(leaf.part)
                return self.value(leaf.part) if leaf.bend is None else self.slope(leaf.part)
            case _:
                assert_never(leaf)

    def _ends(self, part: Part) -> list[Expr]:
        return [end for ends in lower_ray(part.shape, self._o, self._d, self._graph.constant(0.0)) for end in ends]

    def _once(self, kind: str, part: Part, formula: Callable[[], list[Expr]]) -> float:
        definition = part.shape.definition
        is_shared = definition.is_primitive and not any(p.kind in _OWN for p in definition.values)
        key = kind, id(definition) if is_shared else part.shape.id
        if key not in self._known:
            placed = 0.0 if part.inverse is None else 15.0
            self._known[key] = placed + cost(formula())
        return self._known[key]
