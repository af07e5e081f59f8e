"""Axis-aligned boxes: plain numbers, infinite where there is no bound."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

INFINITY = math.inf


@dataclass(frozen=True, slots=True)
class Box:
    """lo <= x <= hi, in two or three dimensions; empty where some lo > hi."""

    lo: tuple[float, ...]
    hi: tuple[float, ...]

    @property
    def is_empty(self) -> bool:
        return any(a > b for a, b in zip(self.lo, self.hi, strict=True))

    @property
    def is_finite(self) -> bool:
        return not self.is_empty and all(map(math.isfinite, (*self.lo, *self.hi)))

    @property
    def centre(self) -> tuple[float, ...]:
        return tuple(0.5 * (a + b) for a, b in zip(self.lo, self.hi, strict=True))

    @property
    def half(self) -> tuple[float, ...]:
        return tuple(0.5 * (b - a) for a, b in zip(self.lo, self.hi, strict=True))

    @property
    def radius(self) -> float:
        """Of the sphere through the corners."""
        return math.hypot(*self.half)

    def widened(self, margin: float) -> Box:
        return Box(tuple(a - margin for a in self.lo), tuple(b + margin for b in self.hi))

    def rounded(self) -> Box:
        """A box around this one, by 1e-12 of its numbers: equal for boxes that only rounding tells apart."""
        if not self.is_finite:
            return self
        largest = max(1e-280, *map(abs, (*self.lo, *self.hi)))
        step = 2.0 ** (math.frexp(0.71 * largest)[1] - 40)  # which jumps at no number that one would write
        lo = (step * math.floor(a / step - 0.25) for a in self.lo)
        return Box(tuple(lo), tuple(step * math.ceil(b / step + 0.25) for b in self.hi))

    def hull(self, other: Box) -> Box:
        if self.is_empty:
            return other
        if other.is_empty:
            return self
        return Box(tuple(map(min, self.lo, other.lo)), tuple(map(max, self.hi, other.hi)))

    def meet(self, other: Box) -> Box:
        return Box(tuple(map(max, self.lo, other.lo)), tuple(map(min, self.hi, other.hi)))

    def moved(self, rows: list[list[float]], offset: list[float]) -> Box:
        """The box of the image under x -> rows x + offset."""
        if self.is_empty:
            return self
        size = len(self.lo)
        lo, hi = [], []
        for row, shift in zip(rows[:size], offset[:size], strict=True):
            # an entry of zero drops its axis, even an infinite one
            ends = [(k * a, k * b) for k, a, b in zip(row, self.lo, self.hi, strict=False) if k != 0.0]
            lo.append(shift + sum(min(pair) for pair in ends))
            hi.append(shift + sum(max(pair) for pair in ends))
        return Box(tuple(lo), tuple(hi))

    def corners(self) -> list[tuple[float, ...]]:
        return list(itertools.product(*zip(self.lo, self.hi, strict=True)))


def everything(dimension: int = 3) -> Box:
    return Box((-INFINITY,) * dimension, (INFINITY,) * dimension)


def nothing(dimension: int = 3) -> Box:
    return Box((INFINITY,) * dimension, (-INFINITY,) * dimension)
