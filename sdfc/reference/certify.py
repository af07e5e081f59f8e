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

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import Expr
from sdfc.field.interval import Parameters
from sdfc.reference.parts import NOBODY, Parts
from sdfc.reference.search import Rays

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Index: TypeAlias = NDArray[np.intp]

RESOLUTION = 1e-11  # of the ray's largest coordinate: the width of a bracket
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
    progress: Callable[[float], None] | None = None,
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
    `progress` is told what share is done.
    """
    rays = Rays.of(o, d, params or {}, resolution, lipschitz)
    parts = Parts(distance, rays)
    count = o.shape[1]
    start, end = (np.broadcast_to(np.asarray(t, float), (count,)).copy() for t in (t_start, t_end))
    tell = progress or _silent
    outer = parts.survey(tolerance, start, end, lambda share: tell(0.8 * share))
    near = ~outer.advance.finished
    early = np.where(near, outer.advance.reached, np.inf)
    index = np.flatnonzero(near)
    entry = _entries(parts, rays, index, early[index], end[index], thin, outer.owner[index])
    tell(0.9)
    result = _assembled(count, index, entry, early, outer.advance.clearance + tolerance)
    if tolerance > 0.0:
        _classify(parts, result, index, entry.owner, end, tolerance)
    else:
        result.t_early[:], result.t_late[:] = result.t_lo, result.t_hi
    return result


def _silent(share: float) -> None:
    """Nobody asked."""


@dataclass(frozen=True, slots=True)
class _Entries:
    status: NDArray[np.int8]
    t_lo: Array
    t_hi: Array
    clearance: Array
    film: Mask
    owner: Index  # the part that is entered


def _entries(parts: Parts, rays: Rays, index: Index, start: Array, end: Array, thin: float, hint: Index) -> _Entries:
    """The first run of each ray `index` that counts: see `first_roots`."""
    count = index.size
    status = np.full(count, Status.AMBIGUOUS, np.int8)
    t_lo, t_hi = start.copy(), np.full(count, np.inf)
    clearance, film, owner = np.full(count, np.inf), np.zeros(count, bool), hint.copy()
    active = np.arange(count)
    for _ in range(MAX_FILMS):
        if active.size == 0:
            break
        found = parts.first(0.0, t_lo[active], end[active], index[active], owner[active])
        got = found.advance
        t_lo[active], owner[active] = got.reached, found.owner
        clearance[active] = np.minimum(clearance[active], got.clearance)
        status[active[got.finished]] = Status.MISS
        stopped = active[~got.finished & ~got.exhausted]
        solid, empty, after = _beyond(parts, rays, index[stopped], t_lo[stopped], thin, owner[stopped])
        hits = stopped[solid]
        status[hits] = Status.HIT
        t_hi[hits] = _first_inside(parts, rays, index[hits], t_lo[hits], after[solid], owner[hits])
        passed = stopped[empty]
        film[passed], clearance[passed] = True, 0.0
        t_lo[passed] = after[empty]
        status[passed[t_lo[passed] >= end[passed]]] = Status.MISS
        active = passed[t_lo[passed] < end[passed]]
    t_lo[status == Status.MISS] = np.inf
    return _Entries(status, t_lo, t_hi, clearance, film, owner)


def _beyond(parts: Parts, rays: Rays, index: Index, t: Array, thin: float, owner: Index) -> tuple[Mask, Mask, Array]:
    """Whether the distance is proved negative, or positive, `thin` behind t (without `thin`: at the first of a few
    points behind it, closer than 256 resolutions, where its sign is proved); and the point."""
    after = t + (np.full(t.shape, thin) if thin > 0.0 else rays.some(index).width(t))
    solid, empty = np.zeros(t.shape, bool), np.zeros(t.shape, bool)
    for _ in range(1 if thin > 0.0 else 9):
        unknown = np.flatnonzero(~(solid | empty))
        if unknown.size == 0:
            break
        lo, hi = parts.at(after[unknown], index[unknown], owner[unknown])
        solid[unknown], empty[unknown] = hi < 0.0, lo > 0.0
        left = unknown[(hi >= 0.0) & (lo <= 0.0)]
        if thin == 0.0:
            after[left] = t[left] + 2.0 * (after[left] - t[left])
    # without `thin` nothing is a film: a touch is a tangency, which is ambiguous
    return solid, empty if thin > 0.0 else np.zeros(t.shape, bool), after


def _first_inside(parts: Parts, rays: Rays, index: Index, t: Array, after: Array, owner: Index) -> Array:
    """A t within (t, after], as near to t as doubling finds it, where the distance is proved negative."""
    result, gap = after.copy(), rays.some(index).width(t)
    searching = np.flatnonzero(t + gap < after)
    while searching.size:
        probe = t[searching] + gap[searching]
        _, hi = parts.at(probe, index[searching], owner[searching])
        result[searching[hi < 0.0]] = probe[hi < 0.0]
        gap[searching] *= 2.0
        searching = searching[(hi >= 0.0) & (t[searching] + gap[searching] < after[searching])]
    return result


def _assembled(count: int, index: Index, entry: _Entries, early: Array, clearance: Array) -> Certificate:
    status = np.full(count, Status.MISS, np.int8)
    t_lo, t_hi, contested = np.full(count, np.inf), np.full(count, np.inf), np.zeros(count, bool)
    status[index], t_lo[index], t_hi[index] = entry.status, entry.t_lo, entry.t_hi
    clearance = clearance.copy()
    clearance[index] = np.where(entry.status == Status.MISS, np.minimum(clearance[index], entry.clearance), 0.0)
    contested[index] = (entry.status == Status.AMBIGUOUS) | entry.film
    return Certificate(status, t_lo, t_hi, clearance, early, np.full(count, np.inf), contested)


def _classify(parts: Parts, result: Certificate, index: Index, owners: Index, end: Array, tolerance: float) -> None:
    """Fills `t_late` and `contested`: see `first_roots`. `owners`: of the rays `index`."""
    contested = result.contested
    contested |= (result.status == Status.MISS) & np.isfinite(result.t_early)
    owner = np.full(result.status.shape, NOBODY)
    owner[index] = owners
    hits = np.flatnonzero(result.status == Status.HIT)
    # distance < -tolerance begins at the first root of distance + tolerance
    deep = parts.first(-tolerance, result.t_lo[hits], end[hits], hits, owner[hits]).advance
    reached = ~deep.finished & ~deep.exhausted
    result.t_late[hits[reached]] = deep.reached[reached]
    contested[hits[~reached]] = True
    sure = hits[reached]
    before = parts.below(2.0 * tolerance, result.t_early[sure], result.t_lo[sure], sure, owner[sure])
    behind = parts.below(tolerance, result.t_hi[sure], result.t_late[sure], sure, owner[sure])
    contested[sure[~(before & behind)]] = True
