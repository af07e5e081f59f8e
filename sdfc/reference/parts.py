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
from sdfc.reference.region import region_of
from sdfc.reference.search import Advance, Array, Index, Level, Mask, Rays, advance

NOBODY = -1
MOST_TURNS = 8  # of all parts, to prove together what none proves alone
WORTHWHILE = 40_000  # nodes of a part times rays: for less it takes longer to find its region than to do without

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
        # known from `survey`: part i is above self._above from the start up to clear[i], and from leave[i] on
        self._clear = np.full((len(self._each), rays.o.shape[1]), -np.inf)
        self._leave = np.full(self._clear.shape, np.inf)
        self._above = np.inf

    def survey(self, level: float, start: Array, end: Array, progress: Progress) -> First:
        """`first` for all rays. What is found is kept for searches at this level and below, from `start` on."""
        everyone, nobody = np.arange(start.size), np.full(start.size, NOBODY)
        clearance = np.inf
        self._clear[:] = start
        reach = np.maximum(np.abs(start), np.abs(end))
        for i, part in enumerate(self._each):
            region = region_of(part, level, self._rays, reach) if part.size * start.size >= WORTHWHILE else None
            if region is not None:
                enter, self._leave[i] = region.interval(self._rays)
                np.maximum(self._clear[i], enter, out=self._clear[i])
                clearance = min(clearance, region.clearance)
            progress(0.2 * (i + 1) / len(self._each))
        found = self._first(level, self._clear, end, everyone, nobody, lambda share: progress(0.2 + 0.8 * share))
        np.minimum(found.advance.clearance, clearance, out=found.advance.clearance)
        self._above = level
        return found

    def first(self, level: float, start: Array, end: Array, index: Index, hint: Index) -> First:
        """How far the rays `index` are above `level` from `start` on. `hint`: the part likely to stop each."""
        assert level <= self._above
        begin = np.maximum(start, self._clear[:, index])
        found = self._first(level, begin, end, index, hint, lambda share: None)
        found.advance.reached = np.maximum(found.advance.reached, start)
        return found

    def _first(self, level: float, begin: Array, end: Array, index: Index, hint: Index, progress: Progress) -> First:
        """From `begin` (parts, rays) on, which is moved to where each part was still above the level."""
        state = Advance(end.copy(), np.ones(index.size, bool), np.full(index.size, np.inf))
        found = First(state, np.full(index.size, NOBODY))
        for count, (part, among) in enumerate(self._turns(hint)):
            until = np.minimum(state.reached, self._leave[part, index])
            asked = np.flatnonzero(among & (begin[part] < until))
            if asked.size:
                some = self._rays.some(index[asked])
                got = advance(self._each[part], some, Level(1.0, level), begin[part, asked], until[asked])
                begin[part, asked] = np.where(got.finished, state.reached[asked], got.reached)
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
        """Where the distance is proved to be below `level` all along: by its owner, or by parts taking turns."""
        sought = Level(-1.0, -level)
        reached = start.copy()
        for _ in range(MOST_TURNS):
            before = reached.copy()
            for part, among in self._turns(owner):
                # a part that is above the surveyed level up to the end is hardly of help
                useful = (owner == part) | (self._clear[part, index] <= end)
                asked = np.flatnonzero(among & useful & (reached < end))
                if asked.size:
                    some = self._rays.some(index[asked])
                    reached[asked] = advance(self._each[part], some, sought, reached[asked], end[asked]).reached
            if not ((reached > before) & (reached < end)).any():
                break
        return np.asarray(reached >= end)


def _put(found: First, part: int, asked: Index, got: Advance) -> None:
    """What a part's search says of the rays that it was asked about."""
    state = found.advance
    state.clearance[asked] = np.minimum(state.clearance[asked], got.clearance)
    stopped = asked[~got.finished]
    state.reached[stopped] = got.reached[~got.finished]
    state.finished[stopped] = False
    state.exhausted[stopped] = got.exhausted[~got.finished]
    found.owner[stopped] = part
