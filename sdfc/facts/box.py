"""Axis-aligned boxes: plain numbers, infinite where there is no bound."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import gt

INFINITY = math.inf


@dataclass(frozen=True, slots=True)
class Box:
    """lo <= x <= hi, in two or three dimensions; empty where some lo > hi."""

    lo: tuple[float, ...]
    hi: tuple[float, ...]

    @property
    def is_empty(self) -> bool:
        return any(map(gt, self.lo, self.hi))

    @property
    def is_finite(self) -> bool:
        return all(map(math.isfinite, self.lo)) and all(map(math.isfinite, self.hi)) and not self.is_empty

    @property
    def centre(self) -> tuple[float, ...]:
        return tuple([0.5 * (a + b) for a, b in zip(self.lo, self.hi, strict=True)])

    @property
    def half(self) -> tuple[float, ...]:
        return tuple([0.5 * (b - a) for a, b in zip(self.lo, self.hi, strict=True)])

    @property
    def radius(self) -> float:
        """Of the sphere through the corners."""
        return math.hypot(*self.half)

    def widened(self, margin: float) -> Box:
        return Box(tuple([a - margin for a in self.lo]), tuple([b + margin for b in self.hi]))

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

    def moved(self, numbers: Sequence[float]) -> Box:
        """The box of the image under an affine map in space: the linear part row by row, then the offset."""
        if self.is_empty:
            return self
        lo, hi = [], []
        for axis in range(len(self.lo)):
            low = high = 0.0
            for k, a, b in zip(numbers[3 * axis : 3 * axis + 3], self.lo, self.hi, strict=False):
                if k > 0.0:  # an entry of zero drops its axis, even an infinite one
                    low, high = low + k * a, high + k * b
                elif k != 0.0:
                    low, high = low + k * b, high + k * a
            lo.append(numbers[9 + axis] + low)
            hi.append(numbers[9 + axis] + high)
        return Box(tuple(lo), tuple(hi))

    def corners(self) -> list[tuple[float, ...]]:
        return list(itertools.product(*zip(self.lo, self.hi, strict=True)))


def hull(boxes: Sequence[Box]) -> Box:
    """The box around all of them."""
    full = [box for box in boxes if not box.is_empty] or boxes[-1:]
    if len(full) == 1:
        return full[0]
    return Box(tuple(map(min, *[box.lo for box in full])), tuple(map(max, *[box.hi for box in full])))


def meeting(boxes: Sequence[Box]) -> Box:
    """The box of what is in all of them."""
    if len(boxes) == 1:
        return boxes[0]
    return Box(tuple(map(max, *[box.lo for box in boxes])), tuple(map(min, *[box.hi for box in boxes])))


def everything(dimension: int = 3) -> Box:
    return Box((-INFINITY,) * dimension, (INFINITY,) * dimension)


def nothing(dimension: int = 3) -> Box:
    return Box((INFINITY,) * dimension, (-INFINITY,) * dimension)
