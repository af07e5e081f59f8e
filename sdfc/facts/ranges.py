"""What values an expression of the params can take: every fact holds for all values in the params' declared ranges."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from sdfc.field.graph import Expr

if TYPE_CHECKING:
    from sdfc.field.interval import ConstantBounds

Range = tuple[tuple[float, ...], tuple[float, ...]]


_PIECES = 16


def _piece(whole: Range, index: int, count: int) -> Range:
    """The part `index` of `count` equal parts of a range; neighbours share their ends."""
    lo, hi = whole
    ends = [tuple(a + (b - a) * i / count for a, b in zip(lo, hi, strict=True)) for i in (index, index + 1)]
    return ends[0], hi if index + 1 == count else ends[1]


def _varying(whole: Range) -> int:
    """How many components of a param vary."""
    return sum(a != b for a, b in zip(*whole, strict=True))


@dataclass(frozen=True)
class Ranges:
    """The range of each param, by component. For the expressions of one graph."""

    of: Mapping[str, Range]
    _found: dict[int, tuple[list[float], list[float]]] = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def _bounds(self) -> ConstantBounds:
        from sdfc.field.interval import ConstantBounds

        return ConstantBounds(self.of)

    def pieces(self, names: Collection[str]) -> list[Mapping[str, Range]]:
        """The ranges of the params named, cut into at most _PIECES boxes that cover them; no vector is cut."""
        live = sorted(name for name in names if _varying(self.of[name]) == 1)
        if not live:
            return [self.of]
        cuts = max(1, int(_PIECES ** (1 / len(live)) + 1e-9))
        shares = [[_piece(self.of[name], i, cuts) for i in range(cuts)] for name in live]
        return [dict(self.of) | dict(zip(live, choice, strict=True)) for choice in itertools.product(*shares)]

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
                if value.id not in self._found:
                    self._found[value.id] = self._live(value)
                low, high = self._found[value.id]
                lo.extend(low)
                hi.extend(high)
        return lo, hi

    def _live(self, value: Expr) -> tuple[list[float], list[float]]:
        lo, hi = self._bounds(value)
        size = value.type.size  # a vector's may still be a scalar's
        return (lo.tolist() * size)[:size], (hi.tolist() * size)[:size]
