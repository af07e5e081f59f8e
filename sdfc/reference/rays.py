"""Bundles of rays, and their intervals with boxes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdfc.facts.box import Box

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Rays:
    """Points o + t d: `o` and unit `d` are (3, n). `travelled` (n,) is the path's length up to t = 0.

    `cone` says how half a pixel grows along the path: its size at the eye, and by length.
    """

    o: Array
    d: Array
    travelled: Array
    cone: tuple[float, float]

    def __len__(self) -> int:
        return int(self.o.shape[1])

    def take(self, index: NDArray[np.int64]) -> Rays:
        """Some of them."""
        return Rays(self.o[:, index], self.d[:, index], self.travelled[index], self.cone)

    def at(self, t: Array) -> Array:
        """Points, (3, n)."""
        return self.o + t * self.d

    def half_pixel(self, t: Array) -> Array:
        """Half a pixel's size there, (n,)."""
        return self.cone[0] + self.cone[1] * (self.travelled + t)


def box_interval(rays: Rays, box: Box) -> tuple[Array, Array]:
    """Where rays enter and leave a box, (n,) each; they miss it unless enter < leave. The box may be infinite."""
    enter = np.full(len(rays), -np.inf)
    leave = np.full(len(rays), np.inf)
    for axis, (low, high) in enumerate(zip(box.lo, box.hi, strict=True)):
        d = rays.d[axis]
        safe = np.where(np.abs(d) < 1e-18, 1e-18, d)
        first, second = (low - rays.o[axis]) / safe, (high - rays.o[axis]) / safe
        enter = np.maximum(enter, np.minimum(first, second))
        leave = np.minimum(leave, np.maximum(first, second))
    return enter, leave


def box_gap(p: Array, box: Box) -> Array:
    """How far (n,) points (3, n) are outside a box, along the axis where they are furthest; negative inside."""
    gap = np.full(p.shape[1], -np.inf)
    for axis, (low, high) in enumerate(zip(box.lo, box.hi, strict=True)):
        np.maximum(gap, low - p[axis], out=gap)
        np.maximum(gap, p[axis] - high, out=gap)
    return gap
