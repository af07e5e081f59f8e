"""Boxes of points that are cut where what is known of them is worst: branch and bound over a box and params' ranges."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sdfc.field.interval_rules import Array


class Cells(ABC):
    """Boxes lo <= p <= hi, (k, n), each of one piece of the params' ranges, its `owner`, and a bound in each, (n,)."""

    def __init__(self, lo: Sequence[float], hi: Sequence[float], pieces: int) -> None:
        self.lo, self.hi = (np.repeat(np.array(end, float)[:, None], pieces, axis=1) for end in (lo, hi))
        self.owner = np.arange(pieces)
        self.bounds = self.bound(self.lo, self.hi, self.owner)
        self.seen = pieces

    @abstractmethod
    def bound(self, lo: Array, hi: Array, owner: NDArray[np.int64]) -> Array:
        """A bound over each of these boxes."""

    def halve(self, worst: NDArray[np.int64]) -> None:
        """Two boxes instead of each of these; a part is no worse than its whole."""
        lo, hi = halves(self.lo[:, worst], self.hi[:, worst])
        owner = np.tile(self.owner[worst], 2)
        parts = np.minimum(self.bound(lo, hi, owner), np.tile(self.bounds[worst], 2))
        keep = np.setdiff1d(np.arange(self.bounds.size), worst)
        self.lo, self.hi = np.concatenate([self.lo[:, keep], lo], 1), np.concatenate([self.hi[:, keep], hi], 1)
        self.owner = np.concatenate([self.owner[keep], owner])
        self.bounds = np.concatenate([self.bounds[keep], parts])
        self.seen += parts.size


def halves(lo: Array, hi: Array) -> tuple[Array, Array]:
    """Both halves of each box (k, n) -> (k, 2 n), cut across its widest side; an infinite one at 0 or doubled."""
    axis = np.argmax(hi - lo, axis=0)
    column = np.arange(lo.shape[1])
    a, b = lo[axis, column], hi[axis, column]
    with np.errstate(invalid="ignore"):
        cut = np.where(np.isfinite(a) & np.isfinite(b), a + 0.5 * (b - a), 0.0)
    cut = np.where(np.isfinite(a) & np.isinf(b), np.maximum(2.0 * np.abs(a), 1.0), cut)
    cut = np.where(np.isinf(a) & np.isfinite(b), -np.maximum(2.0 * np.abs(b), 1.0), cut)
    first_hi, second_lo = hi.copy(), lo.copy()
    first_hi[axis, column], second_lo[axis, column] = cut, cut
    return np.concatenate([lo, second_lo], axis=1), np.concatenate([first_hi, hi], axis=1)
