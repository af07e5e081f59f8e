"""Where a function can be small at all: a box outside which it is proved to be large, found by cutting space.

Cells are boxes; a cell over which the function's interval is above the level is done with, the others are cut into
eight. The box is the hull of what is left. Rays that pass it need not be searched at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sdfc.field.graph import Op, topological
from sdfc.field.interval import IntervalEvaluator, Parameters
from sdfc.reference.search import Array, Mask, Rays

ROUNDS = 12  # of cutting
MOST_CELLS = 4096  # at once
FINE = 0.125  # of the box: cells smaller than that are not cut further
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
        missed = ~(enter <= leave)
        return np.where(missed, np.inf, enter), np.where(missed, -np.inf, leave)


def region_of(evaluator: IntervalEvaluator, level: float, rays: Rays, end: Array) -> Region | None:
    """The region of a function within reach of the rays up to `end`, or None where it is not bounded or not found."""
    inner = 2.0 ** np.ceil(np.log2(max(1.0, float(np.abs(rays.o).max(initial=0.0)))))
    reach = float((np.abs(rays.o).max(axis=0) + np.abs(end) * rays.speed).max(initial=0.0))
    if not reach < FARTHEST or not np.isfinite(rays.o).all():
        return None
    lo, hi = _cells(inner, reach)
    may_unite = all(node.op is not Op.SIGN for node in topological([evaluator.root]))
    clearance = np.inf
    for _ in range(ROUNDS):
        bound = _lower_bound(evaluator, lo, hi, level, rays.params, may_unite)
        left = ~(bound > level)
        clearance = min(clearance, float(np.min(bound[~left], initial=np.inf)))
        lo, hi = lo[:, left], hi[:, left]
        if lo.shape[1] == 0:
            return Region(np.full(3, np.inf), np.full(3, -np.inf), clearance - level)
        size = hi.max(axis=1) - lo.min(axis=1)
        if lo.shape[1] * 8 > MOST_CELLS or ((hi - lo) <= FINE * size[:, None]).all():
            break
        lo, hi = _eighths(lo, hi)
    if np.abs(lo).max() > inner or np.abs(hi).max() > inner:
        return None
    margin = MARGIN * max(inner, 1.0)
    return Region(lo.min(axis=1) - margin, hi.max(axis=1) + margin, clearance - level)


def _lower_bound(
    evaluator: IntervalEvaluator, lo: Array, hi: Array, level: float, params: Parameters, may_unite: bool
) -> Array:
    """Of the function over cells. Jumps have their two sides; a sign's third, 0, would need its own proof."""
    bound, _ = evaluator.value({"p": (lo, hi)}, params)
    bound = bound.copy()
    rest = np.flatnonzero(~(bound > level))
    if may_unite and rest.size:
        sides, _ = evaluator.value_across_jumps(lo[:, rest], hi[:, rest], params)
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


def _eighths(lo: Array, hi: Array) -> tuple[Array, Array]:
    middle = lo + 0.5 * (hi - lo)
    octants = np.stack(np.meshgrid(*[[False, True]] * 3, indexing="ij")).reshape(3, 8, 1)
    first, second = (end[:, None, :] for end in (lo, hi))
    half = middle[:, None, :]
    return np.where(octants, half, first).reshape(3, -1), np.where(octants, second, half).reshape(3, -1)
