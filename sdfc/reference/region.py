"""Where a function can be small at all: a box outside which it is proved to be large, found by cutting space.

Cells are boxes; a cell over which the function's interval is above the level is done with, the others are cut in two,
across the axis that the interval suffers from most. The box is the hull of what is left. Rays that pass it need not be
searched at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdfc.field.graph import Op, topological
from sdfc.field.interval import IntervalEvaluator, Parameters
from sdfc.reference.search import Array, Mask, Rays

ROUNDS = 60  # of cutting
MOST_CELLS = 2048  # at once
BUDGET = 2**14  # cells that are looked at in all
FINE = 0.125  # of the box: cells that are narrower in all directions are cut only where that proves a cell,
FINEST = FINE / 64.0  # and not below this
FLAT = 0.25  # of a cell's width: nor are flat cells made flatter but for a proof
WHOLE = -1
LARGEST = float(np.finfo(np.float64).max)
FARTHEST = 2.0**60  # no cells are made beyond
MARGIN = 1e-9  # of the coordinates: more than the roundings of a ray's intervals with the box


@dataclass(frozen=True, slots=True)
class Region:
    """Outside lo <= p <= hi the function is above the level that was asked for, by `clearance` at least."""

    lo: Array
    hi: Array
    clearance: float

    def interval(self, rays: Rays) -> tuple[Array, Array]:
        """Where rays may be in the region: before the first and after the second t they are not. Missed: inf, -inf."""
        with np.errstate(all="ignore"):
            ends = np.stack([(self.lo[:, None] - rays.o) / rays.d, (self.hi[:, None] - rays.o) / rays.d])
            still = rays.d == 0.0
            within = (rays.o >= self.lo[:, None]) & (rays.o <= self.hi[:, None])
            enter = np.where(still, np.where(within, -np.inf, np.inf), ends.min(axis=0)).max(axis=0)
            leave = np.where(still, np.where(within, np.inf, -np.inf), ends.max(axis=0)).min(axis=0)
        missed = ~(enter <= leave) | (self.lo > self.hi).any()
        return np.where(missed, np.inf, enter), np.where(missed, -np.inf, leave)


def region_of(evaluator: IntervalEvaluator, level: float, rays: Rays, end: Array) -> Region | None:
    """The region of a function within the rays' -end <= t <= end; None where it is not bounded or not found."""
    inner = 2.0 ** np.ceil(np.log2(max(1.0, float(np.abs(rays.o).max(initial=0.0)))))
    reach = float((np.abs(rays.o).max(axis=0) + np.abs(end) * rays.speed).max(initial=0.0))
    if not reach < FARTHEST or not np.isfinite(rays.o).all():
        return None
    cutter = _Cutter(evaluator, level, rays.params)
    lo, hi = cutter.left_of(*_cells(inner, reach))
    kept = [np.zeros((2, 3, 0))]
    for _ in range(ROUNDS):
        if lo.shape[1] == 0 or lo.shape[1] > MOST_CELLS or cutter.seen > BUDGET:
            break
        axis = cutter.axis(lo, hi, np.concatenate([*kept, np.stack([lo, hi])], axis=2))
        cut = axis != WHOLE
        kept.append(np.stack([lo[:, ~cut], hi[:, ~cut]]))
        lo, hi = cutter.left_of(*_halves(lo[:, cut], hi[:, cut], axis[cut]))
    lo, hi = np.concatenate([*kept, np.stack([lo, hi])], axis=2)
    if lo.shape[1] == 0:
        return Region(np.full(3, np.inf), np.full(3, -np.inf), cutter.clearance)
    if np.abs(lo).max() > inner or np.abs(hi).max() > inner:
        return None
    margin = MARGIN * inner
    return Region(lo.min(axis=1) - margin, hi.max(axis=1) + margin, cutter.clearance)


class _Cutter:
    """Tells which cells of space are left, and how to cut them."""

    def __init__(self, evaluator: IntervalEvaluator, level: float, params: Parameters) -> None:
        self._evaluator, self._level, self._params = evaluator, level, params
        # jumps have their two sides; a sign's third, 0, would need a proof of its own
        self._may_unite = all(node.op is not Op.SIGN for node in topological([evaluator.root]))
        self.seen = 0
        self.clearance = np.inf  # of the function above the level, in the cells that are done with

    def left_of(self, lo: Array, hi: Array) -> tuple[Array, Array]:
        """The cells over which the function is not proved to be above the level."""
        self.seen += lo.shape[1]
        bound = self._bound(lo, hi)
        left = ~(bound > self._level)
        self.clearance = min(self.clearance, float(np.min(bound[~left], initial=np.inf)) - self._level)
        return lo[:, left], hi[:, left]

    def axis(self, lo: Array, hi: Array, all_left: Array) -> NDArray[np.intp]:
        """Where to cut each cell: across the axis without whose width its bound would be best; WHOLE: nowhere.

        `all_left` (2, 3, m): the ends of all cells that are left, which say what is narrow.
        """
        count = lo.shape[1]
        middle = lo + 0.5 * (hi - lo)
        flat_lo, flat_hi = (np.tile(end, 3) for end in (lo, hi))
        for axis in range(3):
            part = slice(axis * count, (axis + 1) * count)
            flat_lo[axis, part] = flat_hi[axis, part] = middle[axis]
        self.seen += count
        bound = self._bound(flat_lo, flat_hi).reshape(3, count)
        proves = bound > self._level
        size = (all_left[1].max(axis=1) - all_left[0].min(axis=1))[:, None]
        width = hi - lo
        coarse = (width > FINE * size).any(axis=0)
        may_cut = (coarse & (width > FLAT * width.max(axis=0))) | (proves & (width > FINEST * size))
        # of equals the widest
        bound += 1e-9 * np.abs(bound) * width / np.max(width)
        best = np.argmax(np.where(may_cut, np.maximum(bound, -LARGEST), -np.inf), axis=0)
        return np.where(may_cut.any(axis=0), best, WHOLE)

    def _bound(self, lo: Array, hi: Array) -> Array:
        bound, _ = self._evaluator.value({"p": (lo, hi)}, self._params)
        bound = np.where(np.isnan(bound), -np.inf, bound)
        rest = np.flatnonzero(~(bound > self._level))
        if self._may_unite and rest.size:
            sides, _ = self._evaluator.value_across_jumps(lo[:, rest], hi[:, rest], self._params)
            bound[rest] = np.fmax(bound[rest], sides)
        return bound


def _cells(inner: float, reach: float) -> tuple[Array, Array]:
    """Cubes that fill [-inner, inner]^3, and around it shells of them, each twice as large, up to `reach`."""
    grid = np.stack(np.meshgrid(*[np.arange(-2.0, 2.0)] * 3, indexing="ij")).reshape(3, -1)
    shell = grid[:, _outside(grid)]
    sizes = [inner]
    while 2.0 * sizes[-1] < reach * (1.0 + 1e-9):
        sizes.append(2.0 * sizes[-1])
    corners = [grid * (inner / 2.0), *(shell * size for size in sizes)]
    widths = np.repeat([inner / 2.0, *sizes], [c.shape[1] for c in corners])
    lo = np.concatenate(corners, axis=1)
    return lo, lo + widths


def _outside(grid: Array) -> Mask:
    """Unit cells of [-2, 2]^3 that are not in [-1, 1]^3."""
    return np.asarray(((grid < -1.0) | (grid >= 1.0)).any(axis=0))


def _halves(lo: Array, hi: Array, axis: NDArray[np.intp]) -> tuple[Array, Array]:
    """Both halves of each cell, cut across its axis."""
    column = np.arange(lo.shape[1])
    first_hi, second_lo = hi.copy(), lo.copy()
    first_hi[axis, column] = second_lo[axis, column] = (lo + 0.5 * (hi - lo))[axis, column]
    return np.concatenate([lo, second_lo], axis=1), np.concatenate([first_hi, hi], axis=1)
