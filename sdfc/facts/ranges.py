"""What values an expression of the params can take: every fact holds for all values in the params' declared ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sdfc.field.graph import Expr, Type

Range = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Ranges:
    """The range of each param, by component."""

    of: Mapping[str, Range]

    def interval(self, value: Expr) -> tuple[float, float]:
        """Lower and upper bound of a FLOAT."""
        if value.is_constant:
            return value.number, value.number
        lo, hi = self.bounds([value])
        return lo[0], hi[0]

    def bounds(self, values: Sequence[Expr]) -> tuple[list[float], list[float]]:
        """Lower and upper bounds of the components of each value, in one list each."""
        lo: list[float] = []
        hi: list[float] = []
        for value in values:
            if value.is_constant:
                lo.extend(value.numbers)
                hi.extend(value.numbers)
            else:
                low, high = self._live(value)
                lo.extend(low)
                hi.extend(high)
        return lo, hi

    def _live(self, value: Expr) -> tuple[list[float], list[float]]:
        import numpy as np

        from sdfc.field.interval import IntervalEvaluator

        params = {name: (low, high) for name, (low, high) in self.of.items()}
        lo, hi = IntervalEvaluator(value).value({}, params)
        size = value.type.size
        return np.broadcast_to(np.ravel(lo), (size,)).tolist(), np.broadcast_to(np.ravel(hi), (size,)).tolist()


def as_boolean(ranges: Ranges, condition: Expr) -> bool | None:
    """True or False where it is that for every value of the params, else None."""
    assert condition.type is Type.BOOL
    if condition.is_constant:
        return bool(condition.numbers[0])
    lo, hi = ranges.bounds([condition])
    return bool(lo[0]) if lo[0] == hi[0] else None
