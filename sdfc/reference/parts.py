"""A distance that is the least of many: the search for its first root asks each part only where it can matter.

The first t with min(f, g) <= level is the lesser of the first t with f <= level and the first t with g <= level. So a
part is searched only up to what the others have left, a part far from a ray is dismissed by one interval, and parts
that may jump (the insides of polygons) do not all jump at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from sdfc.field.graph import Expr, Op
from sdfc.field.interval import IntervalEvaluator
from sdfc.reference.search import Advance, Array, Index, Level, Mask, Rays, advance

NOBODY = -1

Progress = Callable[[float], None]


def parts_of(distance: Expr) -> list[Expr]:
    """The operands of the minima at the top: `distance` is the least of them. Iterative: chains are thousands long."""
    found: dict[int, Expr] = {}
    stack = [distance]
    while stack:
        node = stack.pop()
        if node.op is Op.MIN:
            stack.extend(reversed(node.args))
        else:
            found.setdefault(node.id, node)
    return list(found.values())


@dataclass(slots=True)
class First:
    """How far rays are above a level: see `Advance`. `owner`: the part that stops each, or NOBODY."""

    advance: Advance
    owner: Index


class Parts:
    """The parts of a distance along some rays, and how far each is known to be above the highest level asked for."""

    def __init__(self, distance: Expr, rays: Rays) -> None:
        self._whole = IntervalEvaluator(distance)
        # a rate is the whole distance's, not every part's
        parts = [distance] if rays.rate is not None else parts_of(distance)
        self._each = [self._whole] if len(parts) == 1 else [IntervalEvaluator(part) for part in parts]
        self._rays = rays
        self._clear: Array | None = None  # (parts, rays): part i is above self._above from the start up to here
        self._above = -np.inf

    def survey(self, level: float, start: Array, end: Array, progress: Progress) -> First:
        """`first` for all rays. What is found is kept for searches at this level and below, from `start` on."""
        self._clear, self._above = None, level
        clear = np.repeat(start[None], len(self._each), axis=0)
        everyone = np.arange(start.size)
        found = self._first(level, clear, end, everyone, np.full(start.size, NOBODY), progress)
        self._clear = clear
        return found

    def first(self, level: float, start: Array, end: Array, index: Index, hint: Index) -> First:
        """How far the rays `index` are above `level` from `start` on. `hint`: the part likely to stop each."""
        begin = np.repeat(start[None], len(self._each), axis=0)
        if self._clear is not None and level <= self._above:
            np.maximum(begin, self._clear[:, index], out=begin)
        found = self._first(level, begin, end, index, hint, lambda share: None)
        found.advance.reached = np.maximum(found.advance.reached, start)
        return found

    def _first(self, level: float, begin: Array, end: Array, index: Index, hint: Index, progress: Progress) -> First:
        """From `begin` (parts, rays) on, which is moved to where each part was still above the level."""
        state = Advance(end.copy(), np.ones(index.size, bool), np.full(index.size, np.inf))
        found = First(state, np.full(index.size, NOBODY))
        for count, (part, among) in enumerate(self._turns(hint)):
            asked = np.flatnonzero(among & (begin[part] < state.reached))
            if asked.size:
                some = self._rays.some(index[asked])
                got = advance(self._each[part], some, Level(1.0, level), begin[part, asked], state.reached[asked])
                begin[part, asked] = got.reached
                _put(found, part, asked, got)
            progress((count + 1) / len(self._each))
        return found

    def _turns(self, hint: Index) -> Iterator[tuple[int, Mask]]:
        """Each part with the rays that it is searched for now: those it is likely to stop first, then the others."""
        hinted = np.unique(hint[hint != NOBODY])
        for part in hinted:
            yield int(part), hint == part
        for part in range(len(self._each)):
            yield part, hint != part

    def at(self, t: Array, index: Index, owner: Index) -> tuple[Array, Array]:
        """Bounds of the distance at t; where its owner already is below 0, the upper one is the owner's."""
        lo, hi = np.full(t.shape, -np.inf), np.full(t.shape, np.inf)
        for part in np.unique(owner[owner != NOBODY]):
            mine = np.flatnonzero(owner == part)
            some = self._rays.some(index[mine])
            _, hi[mine] = self._each[part].at(some.o, some.d, t[mine], some.params)
        rest = np.flatnonzero(~(hi < 0.0))
        if rest.size:
            some = self._rays.some(index[rest])
            lo[rest], hi[rest] = self._whole.at(some.o, some.d, t[rest], some.params)
        return lo, hi

    def below(self, level: float, start: Array, end: Array, index: Index, owner: Index) -> Mask:
        """Where the distance is proved to be below `level` all along: its owner's, or else the whole."""
        sought = Level(-1.0, -level)
        proved = np.zeros(index.size, bool)
        for part in np.unique(owner[owner != NOBODY]):
            mine = np.flatnonzero(owner == part)
            some = self._rays.some(index[mine])
            proved[mine] = advance(self._each[part], some, sought, start[mine], end[mine]).finished
        rest = np.flatnonzero(~proved)
        if rest.size and len(self._each) > 1:
            some = self._rays.some(index[rest])
            proved[rest] = advance(self._whole, some, sought, start[rest], end[rest]).finished
        return proved


def _put(found: First, part: int, asked: Index, got: Advance) -> None:
    """What a part's search says of the rays that it was asked about."""
    state = found.advance
    state.clearance[asked] = np.minimum(state.clearance[asked], got.clearance)
    stopped = asked[~got.finished]
    state.reached[stopped] = got.reached[~got.finished]
    state.finished[stopped] = False
    state.exhausted[stopped] = got.exhausted[~got.finished]
    found.owner[stopped] = part
