"""How far a ray is proved to be empty: steps of interval arithmetic along segments of rays, in float64."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field.interval import IntervalEvaluator, Parameters

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Index: TypeAlias = NDArray[np.intp]

SMALLEST_SCALE = 1e-6  # coordinates below it do not ask for a narrower bracket
MAX_STEPS = 4000  # per ray and search; what is left then is AMBIGUOUS, never guessed
MOST_SEGMENTS = 16  # of a ray tried at once
FULL = 512  # segments: fewer take hardly less time
FIRST = 0.25  # of what is left of a ray: the next segment to be tried where all of it was not proved at once


@dataclass(frozen=True, slots=True)
class Rays:
    """Rays with everything that a search needs; `some(index)` are some of them."""

    params: Parameters
    o: Array
    d: Array
    resolution: float  # of the largest coordinate
    scale: Array  # (n,) the origin's largest coordinate
    rate: float | None  # a proved Lipschitz constant of the distance, or None
    speed: Array  # |d|, rounded up

    @classmethod
    def of(cls, o: Array, d: Array, params: Parameters, resolution: float, rate: float | None) -> Rays:
        """With what follows from the rays themselves."""
        scale = np.max(np.abs(o), axis=0, initial=0.0)
        return cls(params, o, d, resolution, scale, rate, np.sqrt(np.sum(d * d, axis=0)) * (1.0 + 1e-15))

    def some(self, index: Index | Mask) -> Rays:
        """Some of the rays."""
        o, d = self.o[:, index], self.d[:, index]
        return Rays(self.params, o, d, self.resolution, self.scale[index], self.rate, self.speed[index])

    def width(self, t: Array) -> Array:
        """The width of a bracket near t, in t."""
        return self.resolution * np.maximum(np.maximum(self.scale, np.abs(t) * self.speed), SMALLEST_SCALE) / self.speed


@dataclass(frozen=True, slots=True)
class Level:
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
        """The bounds of its derivative from those of the distance's."""
        return (lo, hi) if self.sign > 0.0 else (-hi, -lo)


@dataclass(slots=True)
class Advance:
    """How far a search got: `reached` (n,), `finished` where it is the end, and the least lower bound met.

    `exhausted`: given up after MAX_STEPS; what is up to `reached` is proved all the same.
    """

    reached: Array
    finished: Mask
    clearance: Array
    exhausted: Mask = field(init=False)

    def __post_init__(self) -> None:
        self.exhausted = np.zeros(self.reached.shape, bool)


def advance(evaluator: IntervalEvaluator, rays: Rays, level: Level, start: Array, end: Array) -> Advance:
    """Moves from `start` towards `end` while emptiness is proved; stops where it cannot be at the rays' resolution."""
    return _Search(evaluator, rays, level, start, end).run()


class _Search:
    """One search of one function. A ray is *open* while the values of whole segments prove them, which is cheap; where
    they do not, it is *close* to something, and slopes are asked as well.
    """

    def __init__(self, evaluator: IntervalEvaluator, rays: Rays, level: Level, start: Array, end: Array) -> None:
        self._evaluator, self._rays, self._level, self._end = evaluator, rays, level, end
        count = start.shape[0]
        self.state = Advance(start.copy(), start >= end, np.full(count, np.inf))
        self._span = np.where(np.isfinite(end), end - start, np.maximum(1.0, np.abs(start)) * 64.0)
        self._width = np.where(np.isfinite(end), self._span, self._span / 8.0)
        self._value = np.full(count, np.nan)  # a lower bound of the function at `reached`; NaN: not asked yet
        self._close = np.zeros(count, bool)

    def run(self) -> Advance:
        active = np.flatnonzero(~self.state.finished)
        for _ in range(MAX_STEPS):
            if active.size == 0:
                break
            close = self._close[active]
            parts = [self._open_step(active[~close]), self._close_step(active[close])]
            active = np.concatenate(parts)
        self.state.exhausted[active] = True
        return self.state

    def _edges(self, active: Index) -> Array:
        """The ends of consecutive segments of each ray, (k + 1, n): several where rays are few, as calls are dear."""
        at_once = max(1, min(MOST_SEGMENTS, FULL // active.size))
        edges = self.state.reached[active] + np.arange(at_once + 1.0)[:, None] * self._width[active]
        return np.minimum(edges, self._end[active])

    def _open_step(self, active: Index) -> Index:
        """Tries whole segments by their values alone; returns the rays that go on."""
        if active.size == 0:
            return active
        edges = self._edges(active)
        some = self._rays.some(np.tile(active, edges.shape[0] - 1))
        bounds = self._evaluator.between(some.o, some.d, edges[:-1].ravel(), edges[1:].ravel(), some.params)
        lo = self._level.bounds(*bounds)[0].reshape(edges[1:].shape)
        empty = (lo > 0.0) | (edges[:-1] >= edges[1:])
        lead = _leading(empty)
        column = np.arange(active.size)
        self._met(active, lo, lead)
        moved, failed = active[lead > 0], active[lead < empty.shape[0]]
        self.state.reached[active] = edges[lead, column]
        self._value[moved] = np.nan
        self._width[active] *= np.where(lead == empty.shape[0], 2.0, 1.0)
        self._close[failed] = self._width[failed] <= FIRST * self._span[failed]
        self._width[failed] = np.minimum(self._width[failed], FIRST * self._span[failed])
        return self._going(active, np.ones(active.size, bool))

    def _going(self, active: Index, go: Mask) -> Index:
        """The rays that are not at their ends, of those that may go on."""
        finished = self.state.reached[active] >= self._end[active]
        self.state.finished[active[finished]] = True
        return active[go & ~finished]

    def _close_step(self, active: Index) -> Index:
        """One step with slopes; returns the rays that go on."""
        if active.size == 0:
            return active
        edges = self._edges(active)
        shape, column = edges[1:].shape, np.arange(active.size)
        some = self._rays.some(np.tile(active, shape[0]))
        a, b = edges[:-1].ravel(), edges[1:].ravel()
        v = np.maximum(self._values(active, some, a), 0.0)
        slab = self._evaluator.along_ray(some.o, some.d, a, b, some.params)
        lo, _ = self._level.bounds(slab.lo, slab.hi)
        fall, rise = self._level.slopes(slab.slope_lo, slab.slope_hi)
        lo = self._past_jumps(some, a, b, lo, fall)
        proved = _proved(some, v, fall)
        proved_end = np.where(np.isinf(proved), np.inf, np.nextafter(a + proved, a))
        empty = ((lo > 0.0) | (proved_end >= b) | (a >= b)).reshape(shape)
        lead = _leading(empty)
        bound = np.maximum(lo, np.where(proved_end >= b, v + np.minimum(fall, 0.0) * (b - a), -np.inf))
        self._met(active, bound.reshape(shape), lead)
        # the first segment that is not proved, and how far into it
        last = np.minimum(lead, shape[0] - 1)
        here = last * active.size + column
        a, b, v, proved, proved_end, rise = (x[here] for x in (a, b, v, proved, proved_end, rise))
        done = lead == shape[0]
        reached = np.where(done, b, np.clip(proved_end, a, b))
        resolution = self._rays.some(active).width(a)
        # where it falls all along, the root (if any) is before a + value / -rise
        newton = np.where(rise < 0.0, 2.0 * (v / -rise - proved), np.inf)
        w = self._width[active]
        shorter = np.minimum(np.maximum(2.0 * proved, w / 8.0), np.maximum(newton, resolution / 2.0))
        self._width[active] = np.where(done, 2.0 * w, np.minimum(shorter, w / 2.0))
        self.state.clearance[active[~done & (reached > a)]] = 0.0  # it fell, nobody knows how far
        self._value[active[reached > self.state.reached[active]]] = np.nan
        self.state.reached[active] = reached
        self._close[active] = ~done
        return self._going(active, done | (b - a > resolution))

    def _values(self, active: Index, some: Rays, a: Array) -> Array:
        """Lower bounds of the function at the starts `a` of segments; the first ones are kept."""
        known = np.concatenate([self._value[active], np.full(a.size - active.size, np.nan)])
        unknown = np.flatnonzero(np.isnan(known))
        if unknown.size:
            step = some.some(unknown)
            value, _ = self._level.bounds(*self._evaluator.at(step.o, step.d, a[unknown], step.params))
            known[unknown] = np.where(np.isnan(value), -np.inf, value)
        self._value[active] = known[: active.size]
        return known

    def _met(self, index: Index, bound: Array, lead: Index) -> None:
        """Remembers the least bound over the segments (k, n) that are proved, and 0 where one was not."""
        bound = np.where(np.isnan(bound), 0.0, np.maximum(bound, 0.0))
        among = np.arange(bound.shape[0])[:, None] < lead
        least = np.where(among, bound, np.inf).min(axis=0)
        self.state.clearance[index] = np.minimum(self.state.clearance[index], least)

    def _past_jumps(self, rays: Rays, a: Array, b: Array, lo: Array, fall: Array) -> Array:
        """A better lower bound over [a, b] where the distance may jump there: that of both sides of the jump."""
        jumping = np.flatnonzero((lo <= 0.0) & np.isneginf(fall))
        if jumping.size == 0:
            return lo
        some = rays.some(jumping)
        sides, _ = self._level.bounds(
            *self._evaluator.across_jumps(some.o, some.d, a[jumping], b[jumping], some.params)
        )
        result = lo.copy()
        result[jumping] = np.maximum(lo[jumping], sides)
        return result


def _leading(empty: Mask) -> Index:
    """How many segments (k, n) of each ray are empty before the first that is not."""
    return np.asarray(np.where(empty.all(axis=0), empty.shape[0], np.argmin(empty, axis=0)), np.intp)


def _proved(rays: Rays, value: Array, fall: Array) -> Array:
    """How far the function stays positive that is `value` and falls no faster than `fall` or the distance's rate."""
    proved = np.where(fall >= 0.0, np.where(value > 0.0, np.inf, 0.0), value / -fall)
    if rays.rate is not None:
        proved = np.maximum(proved, value / (rays.rate * rays.speed))
    proved *= 1.0 - 1e-15  # for the roundings of the quotients; nextafter is for the sum's
    return proved
