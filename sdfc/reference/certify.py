"""The certified first hit of a ray: interval arithmetic in float64, no distance property, no step limit that guesses.

A ray is o + t d, with o and d the float64 values of the float32 numbers that the tracer under test gets. The search
keeps a point a such that distance > 0 is proved on [start, a], and moves it by

* the natural interval of the distance on [a, a + w] (all of it is empty when the lower end is positive),
* the mean value form: with distance >= v at a and slope >= s < 0 on [a, a + w], [a, a + v / -s) is empty
  (Galin et al. 2020; Aydinlilar and Zanni 2023; with the upper slope too it is the interval Newton method, Moore 1966),
* where a Lipschitz constant L is proved: [a, a + v / (L |d|)) is empty (Hart 1996),
* where the distance may jump (a cell border of a repetition): the natural intervals of both sides of the jump. An
  isolated point at the jump itself is left out: a single point is no run of solid.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import Expr
from sdfc.field.interval import IntervalEvaluator, Parameters

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

RESOLUTION = 1e-11  # of the ray's largest coordinate: the width of a bracket
SMALLEST_SCALE = 1e-6  # coordinates below it do not ask for a narrower bracket
MAX_STEPS = 4000  # per ray and search; what is left then is AMBIGUOUS, never guessed
MAX_FILMS = 32  # runs thinner than `thin` that a ray may pass


class Status(IntEnum):
    """What is known of a ray."""

    MISS = 0
    HIT = 1
    AMBIGUOUS = 2


@dataclass(frozen=True, slots=True)
class Certificate:
    """The truth about n rays.

    status     Status per ray. HIT: a run of solid begins within [t_lo, t_hi]. MISS: there is no run up to t_end.
               AMBIGUOUS: interval arithmetic cannot say (a tangency, a ray within a face).
    t_lo, t_hi HIT: the bracket of the entry: distance > 0 is proved before t_lo (films apart), distance < 0 at t_hi.
               MISS: both inf. AMBIGUOUS: t_lo ends what is proved empty.
    clearance  A proved lower bound of the distance along a MISS ray; 0 for the others and where a film was passed.
    t_early    The first t with distance <= tolerance (inf: none): who stops within tolerance stops no earlier.
    t_late     The first t with distance < -tolerance (inf: none): who stops within tolerance does not pass it.
               Without a tolerance these two are t_lo and t_hi.
    contested  The ray's answer may depend on an error of `tolerance` in the distance: see `first_roots`.
    """

    status: NDArray[np.int8]
    t_lo: Array
    t_hi: Array
    clearance: Array
    t_early: Array
    t_late: Array
    contested: Mask


@dataclass(frozen=True, slots=True)
class _Rays:
    """Rays with everything that a search needs; `at(index)` are some of them."""

    evaluator: IntervalEvaluator
    params: Parameters
    o: Array
    d: Array
    resolution: float  # of the largest coordinate
    scale: Array  # (n,) the origin's largest coordinate
    rate: float | None  # a proved Lipschitz constant of the distance, or None
    speed: Array  # |d|, rounded up

    def some(self, index: NDArray[np.intp] | Mask) -> _Rays:
        return _Rays(
            self.evaluator,
            self.params,
            self.o[:, index],
            self.d[:, index],
            self.resolution,
            self.scale[index],
            self.rate,
            self.speed[index],
        )

    def width(self, t: Array) -> Array:
        """The width of a bracket near t, in t."""
        return self.resolution * np.maximum(np.maximum(self.scale, np.abs(t) * self.speed), SMALLEST_SCALE) / self.speed


@dataclass(frozen=True, slots=True)
class _Level:
    """The function whose first root is sought: sign * distance - level. Positive: empty."""

    sign: float
    level: float

    def bounds(self, lo: Array, hi: Array) -> tuple[Array, Array]:
        """The function's bounds from the distance's; exact sign, one rounding of the difference outward."""
        low, high = (lo, hi) if self.sign > 0.0 else (-hi, -lo)
        if self.level == 0.0:
            return low, high
        return np.nextafter(low - self.level, -np.inf), np.nextafter(high - self.level, np.inf)

    def slopes(self, lo: Array, hi: Array) -> tuple[Array, Array]:
        return (lo, hi) if self.sign > 0.0 else (-hi, -lo)


@dataclass(slots=True)
class _Advance:
    """How far a search got: `reached` (n,), `finished` where it is the end, and the least lower bound met."""

    reached: Array
    finished: Mask
    clearance: Array
    exhausted: Mask = field(init=False)

    def __post_init__(self) -> None:
        self.exhausted = np.zeros(self.reached.shape, bool)


@np.errstate(all="ignore")
def first_roots(
    distance: Expr,
    o: Array,
    d: Array,
    t_start: float | Array,
    t_end: float | Array,
    params: Parameters | None = None,
    *,
    resolution: float = RESOLUTION,
    thin: float = 0.0,
    tolerance: float = 0.0,
    lipschitz: float | None = None,
) -> Certificate:
    """The certified first entry of each ray into {distance <= 0} within [t_start, t_end].

    `o`, `d`: (3, n). `t_end` may be inf. `lipschitz`: only a proved constant of `distance`; None if unknown.

    A *run* of solid counts from its first t with distance <= 0 (or not provably > 0) if distance < 0 is proved at
    t + `thin` as well. If distance > 0 is proved there, everything in [t, t + thin] is a film of parts shorter than
    `thin`: it counts as nothing, and the search goes on from t + thin. So a gap shorter than `thin` behind an entry is
    closed before the run is measured. With thin = 0 every proved sign change is a hit. What is neither is AMBIGUOUS.

    With `tolerance` > 0 rays are also classified: a ray is *not* contested exactly if it is proved that
    - MISS: distance > tolerance all along; or
    - HIT: distance goes below -tolerance, and before the entry there is no separate dip: after the first
      distance <= tolerance it stays below 2 tolerance up to the entry, then below tolerance down to -tolerance;
    and no film was passed. With tolerance = 0 only AMBIGUOUS rays and rays that passed a film are contested.
    """
    rays = _rays(distance, o, d, t_start, t_end, params or {}, resolution, lipschitz)
    count = o.shape[1]
    start, end = (np.broadcast_to(np.asarray(t, float), (count,)).copy() for t in (t_start, t_end))
    early, clearance = start.copy(), np.full(count, np.inf)
    near = np.ones(count, bool)
    if tolerance > 0.0:
        outer = _advance(rays, _Level(1.0, tolerance), start, end)
        near, early = ~outer.finished, np.where(outer.finished, np.inf, outer.reached)
        clearance = outer.clearance + tolerance
    index = np.flatnonzero(near)
    entry = _entries(rays.some(index), early[index], end[index], thin)
    result = _assembled(count, index, entry, early if tolerance > 0.0 else np.full(count, np.inf), clearance)
    if tolerance > 0.0:
        _classify(rays, result, end, tolerance)
    else:
        result.t_early[:], result.t_late[:] = result.t_lo, result.t_hi
    return result


@dataclass(frozen=True, slots=True)
class _Entries:
    status: NDArray[np.int8]
    t_lo: Array
    t_hi: Array
    clearance: Array
    film: Mask


def _rays(
    distance: Expr,
    o: Array,
    d: Array,
    t_start: float | Array,
    t_end: float | Array,
    params: Parameters,
    resolution: float,
    lipschitz: float | None,
) -> _Rays:
    scale = np.max(np.abs(o), axis=0, initial=0.0)
    speed = np.sqrt(np.sum(d * d, axis=0)) * (1.0 + 1e-15)
    return _Rays(IntervalEvaluator(distance), params, o, d, resolution, scale, lipschitz, speed)


def _advance(rays: _Rays, level: _Level, start: Array, end: Array) -> _Advance:
    """Moves from `start` towards `end` while emptiness is proved; stops where it cannot be at the rays' resolution."""
    count = start.shape[0]
    state = _Advance(start.copy(), start >= end, np.full(count, np.inf))
    span = np.where(np.isfinite(end), end - start, np.maximum(1.0, np.abs(start)) * 64.0)
    width = np.minimum(span, np.maximum(span / 8.0, rays.width(start)))
    value, _ = level.bounds(*rays.evaluator.at(rays.o, rays.d, start, rays.params))
    active = np.flatnonzero(~state.finished)
    for _ in range(MAX_STEPS):
        if active.size == 0:
            break
        active = _advance_once(rays, level, state, active, end, width, value)
    state.exhausted[active] = True
    return state


def _advance_once(
    rays: _Rays, level: _Level, state: _Advance, active: NDArray[np.intp], end: Array, width: Array, value: Array
) -> NDArray[np.intp]:
    """One step of the active rays; returns those that go on. `value`: a lower bound of the function at `reached`."""
    some = rays.some(active)
    a, w, v = state.reached[active], width[active], np.maximum(value[active], 0.0)
    b = np.minimum(a + w, end[active])
    resolution = some.width(a)
    slab = some.evaluator.along_ray(some.o, some.d, a, b, some.params)
    lo, _ = level.bounds(slab.lo, slab.hi)
    fall, rise = level.slopes(slab.slope_lo, slab.slope_hi)
    lo = _past_jumps(some, level, a, b, lo, fall)
    proved = np.where(fall >= 0.0, np.where(v > 0.0, np.inf, 0.0), v / -fall)
    if rays.rate is not None:
        proved = np.maximum(proved, v / (rays.rate * some.speed))
    proved *= 1.0 - 1e-15  # for the roundings of the quotients; nextafter is for the sum's
    proved_end = np.where(np.isinf(proved), np.inf, np.nextafter(a + proved, a))
    empty = (lo > 0.0) | (proved_end >= b)
    reached = np.where(empty, b, np.minimum(proved_end, b))
    # where it falls all along, the root (if any) is before a + value / -rise
    newton = np.where(rise < 0.0, 2.0 * (v / -rise - proved), np.inf)
    shorter = np.minimum(np.maximum(2.0 * proved, w / 8.0), np.maximum(newton, resolution / 2.0))
    bound = np.maximum(lo, np.where(empty, v + np.minimum(fall, 0.0) * (b - a), -np.inf))
    state.clearance[active] = np.minimum(
        state.clearance[active], np.where(np.isnan(bound), 0.0, np.maximum(bound, 0.0))
    )
    state.reached[active] = reached
    width[active] = np.where(empty, 2.0 * w, np.minimum(shorter, w / 2.0))
    finished = empty & (b >= end[active])
    state.finished[active[finished]] = True
    stuck = ~empty & (b - a <= resolution)
    go = ~finished & ~stuck
    moved = go & (reached > a)
    step = some.some(moved)
    value[active[moved]], _ = level.bounds(*step.evaluator.at(step.o, step.d, reached[moved], step.params))
    return active[go]


def _past_jumps(rays: _Rays, level: _Level, a: Array, b: Array, lo: Array, fall: Array) -> Array:
    """A better lower bound over [a, b] where the distance may jump there: that of both sides of the jump."""
    jumping = np.flatnonzero((lo <= 0.0) & np.isneginf(fall))
    if jumping.size == 0:
        return lo
    some = rays.some(jumping)
    sides, _ = level.bounds(*some.evaluator.across_jumps(some.o, some.d, a[jumping], b[jumping], some.params))
    result = lo.copy()
    result[jumping] = np.maximum(lo[jumping], sides)
    return result


def _entries(rays: _Rays, start: Array, end: Array, thin: float) -> _Entries:
    """The first run of each ray that counts: see `first_roots`."""
    count = start.shape[0]
    plain = _Level(1.0, 0.0)
    status = np.full(count, Status.AMBIGUOUS, np.int8)
    t_lo, t_hi = start.copy(), np.full(count, np.inf)
    clearance, film = np.full(count, np.inf), np.zeros(count, bool)
    active = np.arange(count)
    for _ in range(MAX_FILMS):
        if active.size == 0:
            break
        some = rays.some(active)
        got = _advance(some, plain, t_lo[active], end[active])
        t_lo[active] = got.reached
        clearance[active] = np.minimum(clearance[active], got.clearance)
        status[active[got.finished]] = Status.MISS
        stopped = active[~got.finished & ~got.exhausted]
        solid, empty, after = _beyond(rays.some(stopped), t_lo[stopped], thin)
        hits = stopped[solid]
        status[hits] = Status.HIT
        t_hi[hits] = _first_inside(rays.some(hits), t_lo[hits], after[solid])
        passed = stopped[empty]
        film[passed], clearance[passed] = True, 0.0
        t_lo[passed] = after[empty]
        status[passed[t_lo[passed] >= end[passed]]] = Status.MISS
        active = passed[t_lo[passed] < end[passed]]
    t_lo[status == Status.MISS] = np.inf
    return _Entries(status, t_lo, t_hi, clearance, film)


def _beyond(rays: _Rays, t: Array, thin: float) -> tuple[Mask, Mask, Array]:
    """Whether the distance is proved negative, or positive, `thin` behind t (without `thin`: at the first of a few
    points behind it, closer than 256 resolutions, where its sign is proved); and the point."""
    after = t + (np.full(t.shape, thin) if thin > 0.0 else rays.width(t))
    solid, empty = np.zeros(t.shape, bool), np.zeros(t.shape, bool)
    for _ in range(1 if thin > 0.0 else 9):
        unknown = np.flatnonzero(~(solid | empty))
        if unknown.size == 0:
            break
        some = rays.some(unknown)
        lo, hi = rays.evaluator.at(some.o, some.d, after[unknown], rays.params)
        solid[unknown], empty[unknown] = hi < 0.0, lo > 0.0
        left = unknown[(hi >= 0.0) & (lo <= 0.0)]
        if thin == 0.0:
            after[left] = t[left] + 2.0 * (after[left] - t[left])
    # without `thin` nothing is a film: a touch is a tangency, which is ambiguous
    return solid, empty if thin > 0.0 else np.zeros(t.shape, bool), after


def _first_inside(rays: _Rays, t: Array, after: Array) -> Array:
    """A t within (t, after], as near to t as doubling finds it, where the distance is proved negative."""
    result, gap = after.copy(), rays.width(t)
    searching = np.flatnonzero(t + gap < after)
    while searching.size:
        some = rays.some(searching)
        probe = t[searching] + gap[searching]
        _, hi = rays.evaluator.at(some.o, some.d, probe, rays.params)
        result[searching[hi < 0.0]] = probe[hi < 0.0]
        gap[searching] *= 2.0
        searching = searching[(hi >= 0.0) & (t[searching] + gap[searching] < after[searching])]
    return result


def _assembled(count: int, index: NDArray[np.intp], entry: _Entries, early: Array, clearance: Array) -> Certificate:
    status = np.full(count, Status.MISS, np.int8)
    t_lo, t_hi, contested = np.full(count, np.inf), np.full(count, np.inf), np.zeros(count, bool)
    status[index], t_lo[index], t_hi[index] = entry.status, entry.t_lo, entry.t_hi
    clearance[index] = np.where(entry.status == Status.MISS, np.minimum(clearance[index], entry.clearance), 0.0)
    contested[index] = (entry.status == Status.AMBIGUOUS) | entry.film
    return Certificate(status, t_lo, t_hi, clearance, early, np.full(count, np.inf), contested)


def _classify(rays: _Rays, result: Certificate, end: Array, tolerance: float) -> None:
    """Fills `t_late` and `contested`: see `first_roots`."""
    contested = result.contested
    contested |= (result.status == Status.MISS) & np.isfinite(result.t_early)
    hits = np.flatnonzero(result.status == Status.HIT)
    # distance < -tolerance begins at the first root of distance + tolerance
    deep = _advance(rays.some(hits), _Level(1.0, -tolerance), result.t_lo[hits], end[hits])
    reached = ~deep.finished & ~deep.exhausted
    result.t_late[hits[reached]] = deep.reached[reached]
    contested[hits[~reached]] = True
    sure = hits[reached]
    before = _advance(rays.some(sure), _Level(-1.0, -2.0 * tolerance), result.t_early[sure], result.t_lo[sure])
    behind = _advance(rays.some(sure), _Level(-1.0, -tolerance), result.t_hi[sure], result.t_late[sure])
    contested[sure[~(before.finished & behind.finished)]] = True
