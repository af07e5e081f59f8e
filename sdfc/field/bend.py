"""How hard a field may bend down in a box: the second-order twin of a Lipschitz constant.

Bounds of second derivatives by intervals, over boxes of points and cells of directions (`interval_bends`).
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sdfc.field import interval_rules as rules
from sdfc.field.cells import Cells
from sdfc.field.core import DEEP
from sdfc.field.graph import Expr, Op, topological
from sdfc.field.interval_bends import BENDS, Bend, everything_where, moving
from sdfc.field.interval_rules import RULES, Array, Interval
from sdfc.field.interval_slopes import SLOPES, Slope
from sdfc.field.memory import MEMORY, fingerprint, params_fingerprint
from sdfc.field.order import evaluation_order

BOXES = 512  # how many boxes `bend_bounds` looks at
CELLS = 4  # its directions: half of a cube's faces in CELLS x CELLS cells
AT_ONCE = 64  # boxes that are cut in one go
_NEAR = 2.0**-20  # of the box: what is infinite so near to a corner of the cuts, cuts do not mend
_CUTS, _GAIN = 6, 0.9  # so many cuts are to bring this, or there are no more: half the bend saves a fifth of the steps


class BendEvaluator:
    """Bounds of one expression's second derivative along lines, over boxes.

    `convex` tells of nodes that are convex functions of a vector below them, and how steep: they bend down no more
    than the vector bends at all.
    """

    def __init__(self, root: Expr, convex: Mapping[int, tuple[Expr, float]]) -> None:
        self.root = root
        met = {node.id for node in evaluation_order([root])}
        # the vectors too, and first: where a formula uses no more than their components they are not below the root
        points = [point for node, (point, _) in convex.items() if node in met]
        self._nodes = evaluation_order([*points, root])
        self._convex = convex

    def __call__(self, box: Interval, direction: Interval, params: Mapping[str, Interval]) -> tuple[Interval, Interval]:
        """The value and the second derivative along every direction d of a cell (k, n), over boxes of p (k, n)."""
        values: dict[int, Interval] = {}
        slopes: dict[int, Slope] = {}
        bends: dict[int, Bend] = {}
        with np.errstate(all="ignore"):
            for node in self._nodes:
                slope, bend = None, None
                match node.op:
                    case Op.CONST:
                        numbers = np.array(node.numbers)
                        value = Interval(*[numbers if node.type.size == 1 else numbers[:, None]] * 2)
                    case Op.PARAM:
                        value = params[str(node.value)]
                    case Op.INPUT:
                        value, slope = box, direction
                    case _:
                        v = [values[a.id] for a in node.args]
                        s = [slopes[a.id] for a in node.args]
                        b = [bends[a.id] for a in node.args]
                        value = rules.settled(RULES[node.op](node, v))
                        if any(x is not None for x in s):
                            slope = SLOPES[node.op](node, v, s, value)
                            bend = self._bend(node, BENDS[node.op](node, v, s, b, value, slope), slope, bends)
                values[node.id], slopes[node.id], bends[node.id] = value, slope, bend
            return values[self.root.id], rules.settled(moving(bends[self.root.id]))

    def _bend(self, node: Expr, bend: Bend, slope: Slope, bends: Mapping[int, Bend]) -> Bend:
        if slope is not None:
            slope = rules.settled(slope)
            bend = everything_where(np.isinf(slope.lo) | np.isinf(slope.hi), bend)
        if bend is None:
            return None
        bend = rules.settled(bend)
        if node.id in self._convex:
            point, steep = self._convex[node.id]
            below = bends[point.id]
            least = np.zeros(1) if below is None else -rules.up(steep * rules.length(rules.settled(below)).hi)
            bend = Interval(np.maximum(bend.lo, np.where(np.isnan(least), -np.inf, least)), bend.hi)
        return bend


def bend_bounds(
    root: Expr,
    lo: Sequence[float],
    hi: Sequence[float],
    pieces: Sequence[Mapping[str, tuple[Sequence[float], Sequence[float]]]],
    convex: Mapping[int, tuple[Expr, float]],
    boxes: int = BOXES,
) -> list[float]:
    """K such that `root` (FLOAT in the VEC3 `p`) falls no faster than f + f' x - K x x / 2 along any line in the box.

    One for each of `pieces`, which are ranges of the params. Only while the root is not below -DEEP: what happens
    inside the solid does not count. Infinite if none is found. The box is cut where the bounds are worst until `boxes`
    have been looked at, or cutting does not help.
    """

    def search() -> list[float]:
        evaluator = BendEvaluator(root, convex)
        cells = _Cells(evaluator, pieces, lo, hi, _anywhere())
        if not np.isfinite(cells.bounds).any() and cells.is_vain():
            return [np.inf] * len(pieces)
        while cells.seen < boxes and not np.isfinite(cells.bounds).all():
            cells.cut()
        if np.isfinite(cells.bounds).all():  # it is worth the dearer look, by directions
            cells = _Cells(evaluator, pieces, lo, hi, _directions())
            before = np.full(len(pieces), np.inf)
            while cells.seen < boxes and (cells.worst() < _GAIN * before).any():
                before = cells.worst()
                for _ in range(_CUTS):
                    cells.cut()
        return [float(k) for k in cells.worst()]

    ranges = tuple(params_fingerprint(piece) for piece in pieces)
    question = "bend", _formulas(root, convex), tuple(lo), tuple(hi), ranges, boxes
    return list(MEMORY.recall(question, search))


def _formulas(root: Expr, convex: Mapping[int, tuple[Expr, float]]) -> Hashable:
    """What is asked about, whatever graph it is of."""
    known = [(node, *convex[node.id]) for node in topological([root]) if node.id in convex]
    return fingerprint([root, *(e for node, point, _ in known for e in (node, point))]), tuple(s for _, _, s in known)


class _Cells(Cells):
    """With how hard the root may bend down in each."""

    def __init__(
        self,
        evaluator: BendEvaluator,
        pieces: Sequence[Mapping[str, tuple[Sequence[float], Sequence[float]]]],
        lo: Sequence[float],
        hi: Sequence[float],
        cells: Interval,
    ) -> None:
        self._evaluator = evaluator
        self._cells = cells
        self._params = {
            name: tuple(np.stack([np.ravel(np.asarray(piece[name][end], float)) for piece in pieces]) for end in (0, 1))
            for name in pieces[0]
        }
        self._count = len(pieces)
        super().__init__(lo, hi, self._count)

    def worst(self) -> Array:
        """For each piece, (pieces,)."""
        result = np.zeros(self._count)
        np.maximum.at(result, self.owner, self.bounds)
        return result

    def cut(self) -> None:
        """Halves the worst boxes of each piece."""
        limit = 0.7 * self.worst()[self.owner]
        bad = np.flatnonzero((self.bounds >= limit) & (self.bounds > 0.0))
        if not bad.size:
            return
        bad = bad[np.argsort(-self.bounds[bad], kind="stable")][: max(AT_ONCE, 2 * self._count)]
        self.halve(bad)

    def is_vain(self) -> bool:
        """Whether all are infinite right beside the middle, where the hub of a ring is: however boxes are cut, one of
        them keeps that."""
        sides = np.array(list(itertools.product((-1.0, 1.0), repeat=self.lo.shape[0]))).T
        middle, near = 0.5 * (self.lo + self.hi), _NEAR * (self.hi - self.lo)
        ends = middle[:, :, None], (middle[:, :, None] + near[:, :, None] * sides[:, None, :])
        lo, hi = (pick(*ends).reshape(self.lo.shape[0], -1) for pick in (np.minimum, np.maximum))
        found = self.bound(lo, hi, np.repeat(self.owner, sides.shape[1]))
        return bool(np.isinf(found).reshape(self._count, -1).any(axis=1).all())

    def bound(self, lo: Array, hi: Array, owner: NDArray[np.int64]) -> Array:
        each, count = self._cells.lo.shape[1], lo.shape[1]
        box = Interval(np.repeat(lo, each, axis=1), np.repeat(hi, each, axis=1))
        params = {
            name: Interval(*(_rows(np.repeat(end[owner], each, axis=0)) for end in ends))
            for name, ends in self._params.items()
        }
        cells = Interval(np.tile(self._cells.lo, count), np.tile(self._cells.hi, count))
        value, bend = self._evaluator(box, cells, params)
        down = np.where(value.hi < -DEEP, 0.0, np.maximum(-bend.lo, 0.0))
        worst: Array = np.broadcast_to(down, (each * count,)).reshape(count, each).max(axis=1)
        return worst


def _rows(values: Array) -> Array:
    """(n, k) as the evaluator has a FLOAT, (n,), or a VECk, (k, n)."""
    return values[:, 0] if values.shape[1] == 1 else values.T


def _anywhere() -> Interval:
    """One cell, of all directions."""
    return Interval(-np.ones((3, 1)), np.ones((3, 1)))


def _directions() -> Interval:
    """Cells that cover the half of all directions (the other half is the same lines), as boxes of unit vectors."""
    ends = np.linspace(-1.0, 1.0, CELLS + 1)
    low = np.stack([a.ravel() for a in np.meshgrid(ends[:-1], ends[:-1])])
    square = Interval(low, low + 2.0 / CELLS)
    size = rules.magnitude(square)
    over = Interval(*(1.0 / np.sqrt(1.0 + np.sum(end * end, axis=0)) for end in (size.hi, size.lo)))
    sides = rules.multiplied(square, over)
    face = Interval(*(np.concatenate([side, third[None]]) for side, third in zip(sides, over, strict=True)))
    lo, hi = (np.concatenate([np.roll(end, turn, axis=0) for turn in range(3)], axis=1) for end in face)
    return Interval(lo - 1e-12, hi + 1e-12)
