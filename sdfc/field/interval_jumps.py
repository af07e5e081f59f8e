"""Both sides of a jump: how a segment across a cell border of a repetition is still proved empty.

Where floor, round, sign, mod, a comparison or atan2's cut is undecided over a segment, its interval is the hull of
both sides, and holds everything between: useless, however short the segment is. Here each undecided operation takes one
side; the caller runs through the combinations of sides and unites the results. What lies on a side is as tight as ever.

At the jump itself sign is 0, which is neither side: the union is right but for isolated points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.field import interval_rules as rules
from sdfc.field.graph import Expr, Op
from sdfc.field.interval_rules import Interval

Mask: TypeAlias = NDArray[np.bool_]
# (arguments, the plain result) -> (the lower side, the upper side, where it is one of these two)
SidesRule: TypeAlias = Callable[[Sequence[Interval], Interval], tuple[Interval, Interval, Mask]]

ORDERED = frozenset({Op.LESS, Op.LESS_EQUAL})
MAX_JUMPS = 3  # undecided operations at once that are run through, so 8 combinations


class Sides:
    """One combination: the i-th undecided operation of each point takes its upper side where bit i is set.

    An operation with more than two sides, and what is undecided after MAX_JUMPS others, keeps the hull. Comparisons of
    the same two values agree: a < b is true where b <= a is false (a polygon's edges meet at such a pair).
    """

    def __init__(self, combination: int, points: int) -> None:
        self._combination = combination
        self.jumps = np.zeros(points, np.int64)  # operations of each point that took a side so far
        # (a, b) -> the side that a < b took, and where it took one
        self._compared: dict[tuple[int, ...], tuple[Interval, Mask]] = {}

    def take(self, node: Expr, args: Sequence[Interval], result: Interval) -> Interval:
        """The side of `result` that this combination takes."""
        lower, upper, undecided = JUMPS[node.op](args, result)
        if not undecided.any():
            return result
        pair, before = tuple(a.id for a in node.args), np.zeros_like(undecided)
        if node.op in ORDERED and pair in self._compared:
            known, before = self._compared[pair]
            result = Interval(np.where(before, known.lo, result.lo), np.where(before, known.hi, result.hi))
            undecided = undecided & ~before
        side, taken = self._side(lower, upper, undecided, result)
        if node.op in ORDERED:
            # the order of two values is one decision, whoever asks and which way round
            self._compared[pair] = side, taken | before
            self._compared[pair[::-1]] = rules.complement(side), taken | before
        return side

    def _side(self, lower: Interval, upper: Interval, undecided: Mask, result: Interval) -> tuple[Interval, Mask]:
        # components one by one: each may jump on its own
        rows = np.atleast_2d(undecided).astype(np.int64)
        position = self.jumps + np.cumsum(rows, axis=0) - rows
        taken = (rows > 0) & (position < MAX_JUMPS)
        up = ((self._combination >> np.minimum(position, MAX_JUMPS)) & 1) > 0
        self.jumps = self.jumps + taken.sum(axis=0)
        if undecided.ndim == 1:
            taken, up = taken[0], up[0]
        lo = np.where(taken, np.where(up, upper.lo, lower.lo), result.lo)
        hi = np.where(taken, np.where(up, upper.hi, lower.hi), result.hi)
        # either side is within the plain result, which may know more: mod's range, the half turn
        return Interval(np.maximum(lo, result.lo), np.minimum(hi, result.hi)), taken


def _steps(args: Sequence[Interval], result: Interval) -> tuple[Interval, Interval, Mask]:
    """floor, round: whole numbers."""
    return Interval(result.lo, result.lo), Interval(result.hi, result.hi), result.hi - result.lo == 1.0


def _ends(args: Sequence[Interval], result: Interval) -> tuple[Interval, Interval, Mask]:
    """sign and comparisons: an end or the other."""
    return Interval(result.lo, result.lo), Interval(result.hi, result.hi), result.lo < result.hi


def _modulo(args: Sequence[Interval], result: Interval) -> tuple[Interval, Interval, Mask]:
    """Two neighbouring quotients."""
    quotient, _ = rules.floor_quotient(args[0], args[1])
    lower, upper = (rules.subtracted(args[0], rules.multiplied(args[1], Interval(end, end))) for end in quotient)
    return lower, upper, quotient.hi - quotient.lo == 1.0


def _arc_tangent2(args: Sequence[Interval], result: Interval) -> tuple[Interval, Interval, Mask]:
    """Below and above the cut; at the origin every angle is possible."""
    y, x = args
    below = rules.corner_angles(Interval(y.lo, np.full_like(y.hi, -0.0)), x)
    above = rules.corner_angles(Interval(np.zeros_like(y.lo), y.hi), x)
    return below, above, rules.on_branch_cut(y, x) & (x.hi < 0.0)


JUMPS: dict[Op, SidesRule] = {
    Op.FLOOR: _steps,
    Op.ROUND: _steps,
    Op.SIGN: _ends,
    Op.MOD: _modulo,
    Op.LESS: _ends,
    Op.LESS_EQUAL: _ends,
    Op.EQUAL: _ends,
    Op.ATAN2: _arc_tangent2,
}
