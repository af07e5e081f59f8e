"""First hits of hard CSG by merging ray intervals (Roth 1982) in float64: an oracle independent of the tracers.

A leaf gives the intervals in which each ray is inside it; a node merges its parts' sorted events by counting. No field
is evaluated and nothing is stepped, so this is independent of `certify` and of the tracers' event stepping.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, assert_never

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Leaf:
    """A solid by its closed ray intervals [enter, exit], (k, n) each; empty where not enter < exit (NaN too)."""

    enter: Array
    exit: Array


@dataclass(frozen=True, slots=True)
class Either:
    """The union of the parts."""

    parts: tuple[Solid, ...]


@dataclass(frozen=True, slots=True)
class Both:
    """The intersection of the parts."""

    parts: tuple[Solid, ...]


@dataclass(frozen=True, slots=True)
class Without:
    """`solid` less `removed`."""

    solid: Solid
    removed: Solid


Solid: TypeAlias = Leaf | Either | Both | Without


@dataclass(frozen=True, slots=True)
class FirstRun:
    """The first run of solid on each ray that counts, (n,) each.

    hit        whether there is one that begins in [t_start, t_end]
    t          where it begins (t_start inside a solid); inf without a hit
    thickness  its length; 0 without a hit
    gap        the shortest void between two runs of the ray that was not closed; inf with fewer than two runs
    films      how many runs before the first that counts, or on the whole ray without a hit, were too thin to count
    """

    hit: NDArray[np.bool_]
    t: Array
    thickness: Array
    gap: Array
    films: NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class _Runs:
    """Disjoint intervals in ascending order, (k, n); unused places at the end are [inf, inf]."""

    enter: Array
    exit: Array


def first_runs(solid: Solid, t_start: float | Array, t_end: float | Array, thin: float = 0.0) -> FirstRun:
    """Merges the tree's intervals and picks each ray's first run within [t_start, t_end].

    First everything before t_start is cut off; then gaps shorter than `thin` are closed; then runs shorter than `thin`,
    and those of no length, are dropped. A run that begins before t_end counts by its whole length.
    """
    runs = _merged(solid)
    enter = np.where(runs.exit > t_start, np.maximum(runs.enter, t_start), np.inf)
    exit_ = np.where(runs.exit > t_start, runs.exit, np.inf)
    closed = _closed(_sorted(enter, exit_), thin)
    with np.errstate(invalid="ignore"):
        length = np.where(closed.enter < np.inf, closed.exit - closed.enter, 0.0)
        gaps = np.where(closed.enter[1:] < np.inf, closed.enter[1:] - closed.exit[:-1], np.inf)
    counts = (length >= thin) & (length > 0.0) & (closed.enter <= t_end)
    hit = np.asarray(counts.any(axis=0))
    first = np.argmax(counts, axis=0)[None]
    t = np.where(hit, np.take_along_axis(closed.enter, first, axis=0)[0], np.inf)
    thickness = np.where(hit, np.take_along_axis(length, first, axis=0)[0], 0.0)
    films = ((length > 0.0) & ~counts & (closed.enter < t) & (closed.enter <= t_end)).sum(axis=0)
    return FirstRun(hit, t, thickness, np.min(gaps, axis=0, initial=np.inf), films)


def _merged(solid: Solid) -> _Runs:
    """The runs of the whole tree; iterative, for trees thousands deep."""
    done: dict[int, _Runs] = {}
    stack: list[tuple[Solid, bool]] = [(solid, False)]
    while stack:
        node, ready = stack.pop()
        parts = _parts(node)
        if ready or not parts:
            done[id(node)] = _node_runs(node, [done[id(part)] for part in parts])
        else:
            stack.append((node, True))
            stack.extend((part, False) for part in parts if id(part) not in done)
    return done[id(solid)]


def _parts(node: Solid) -> tuple[Solid, ...]:
    match node:
        case Leaf():
            return ()
        case Either(parts) | Both(parts):
            return parts
        case Without(kept, removed):
            return (kept, removed)
        case _:
            assert_never(node)


def _node_runs(node: Solid, parts: list[_Runs]) -> _Runs:
    match node:
        case Leaf(enter, exit_):
            some = enter < exit_
            single = _sorted(np.where(some, enter, np.inf), np.where(some, exit_, np.inf))
            return _where_count([single], 1)
        case Either():
            return _where_count(parts, 1)
        case Both():
            return _where_count(parts, len(parts))
        case Without():
            return _where_count([parts[0], _complement(parts[1])], 2)
        case _:
            assert_never(node)


def _sorted(enter: Array, exit_: Array) -> _Runs:
    order = np.argsort(enter, axis=0, kind="stable")
    return _Runs(np.take_along_axis(enter, order, axis=0), np.take_along_axis(exit_, order, axis=0))


def _complement(runs: _Runs) -> _Runs:
    """What lies between the runs, with the ends of the line."""
    first = np.full((1, runs.enter.shape[1]), -np.inf)
    enter, exit_ = np.concatenate([first, runs.exit]), np.concatenate([runs.enter, -first])
    some = enter < exit_
    return _sorted(np.where(some, enter, np.inf), np.where(some, exit_, np.inf))


def _where_count(parts: list[_Runs], needed: int) -> _Runs:
    """Where at least `needed` of the parts' intervals overlap, as disjoint runs."""
    enter = np.concatenate([part.enter for part in parts])
    times = np.concatenate([enter, np.concatenate([part.exit for part in parts])])
    change = np.where(np.arange(times.shape[0]) < enter.shape[0], 1, -1)
    # stable: at equal t the entries come before the exits, so that touching intervals become one
    order = np.argsort(times, axis=0, kind="stable")
    times = np.take_along_axis(times, order, axis=0)
    count = np.cumsum(change[order], axis=0)
    before = np.concatenate([np.zeros((1, times.shape[1]), count.dtype), count[:-1]])
    begins = (before < needed) & (count >= needed) & (times < np.inf)
    ends = (before >= needed) & (count < needed)
    starts = np.sort(np.where(begins, times, np.inf), axis=0)
    stops = np.sort(np.where(ends, times, np.inf), axis=0)
    used = max(1, int(begins.sum(axis=0).max(initial=0)))
    return _Runs(starts[:used], stops[:used])


def _closed(runs: _Runs, thin: float) -> _Runs:
    """The runs with gaps shorter than `thin` closed."""
    if thin <= 0.0 or runs.enter.shape[0] < 2:
        return runs
    with np.errstate(invalid="ignore"):
        close = (runs.enter[1:] - runs.exit[:-1] < thin) & (runs.enter[1:] < np.inf)
    enter, exit_ = runs.enter.copy(), runs.exit.copy()
    enter[1:][close] = np.inf
    exit_[:-1][close] = np.inf
    return _Runs(np.sort(enter, axis=0), np.sort(exit_, axis=0))
