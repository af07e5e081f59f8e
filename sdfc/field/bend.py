"""How hard a field may bend down in a box: the second-order twin of a Lipschitz constant.

Bounds of second derivatives by intervals, over boxes of points and cells of directions (`interval_bends`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sdfc.field import interval_rules as rules
from sdfc.field.graph import Expr, Op
from sdfc.field.interval import halves
from sdfc.field.interval_bends import BENDS, Bend, everything_where, moving
from sdfc.field.interval_rules import RULES, Array, Interval
from sdfc.field.interval_slopes import SLOPES, Slope
from sdfc.field.order import evaluation_order


BOXES = 256  # how many boxes `bend_bound` looks at
CELLS = 5  # its directions: half of a cube's faces in CELLS x CELLS cells
AT_ONCE = 64  # boxes that are cut in one go


class BendEvaluator:
    """Bounds of one expression's second derivative along lines, over boxes.

    `convex` tells of nodes that are convex functions of a vector below them, and how steep: they bend down no more
    than the vector bends at all.
    """

    def __init__(self, root: Expr, convex: Mapping[int, tuple[Expr, float]]) -> None:
        self.root = root
        self._nodes = evaluation_order([root])
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


def bend_bound(
    root: Expr,
    lo: Sequence[float],
    hi: Sequence[float],
    params: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    convex: Mapping[int, tuple[Expr, float]],
    boxes: int = BOXES,
) -> float:
    """K such that `root` (FLOAT in the VEC3 `p`) falls no faster than f + f' x - K x x / 2 along any line in the box.

    Only while it is not negative: what happens inside the solid does not count. Infinite if none is found. The box is
    cut where its bound is worst until `boxes` have been looked at.
    """
    evaluator, cells = BendEvaluator(root, convex), _directions()
    known = {name: _column(*pair) for name, pair in params.items()}
    low, high = np.array(lo, float)[:, None], np.array(hi, float)[:, None]
    bounds, seen = _box_bends(evaluator, low, high, cells, known), 1
    while seen < boxes and bounds.max() > 0.0:
        worst = np.argsort(bounds)[::-1][: max(1, min((boxes - seen) // 2, AT_ONCE))]
        limit = 0.7 * bounds.max() if np.isfinite(bounds.max()) else np.inf
        worst = worst[bounds[worst] >= limit]
        parts = halves(low[:, worst], high[:, worst])
        cut = np.minimum(_box_bends(evaluator, *parts, cells, known), np.tile(bounds[worst], 2))
        seen += cut.size
        keep = np.setdiff1d(np.arange(bounds.size), worst)
        low, high = np.concatenate([low[:, keep], parts[0]], 1), np.concatenate([high[:, keep], parts[1]], 1)
        bounds = np.concatenate([bounds[keep], cut])
    return float(bounds.max())


def _column(lo: Sequence[float], hi: Sequence[float]) -> Interval:
    ends = [np.asarray(end, float) for end in (lo, hi)]
    return Interval(*(end.reshape(-1) if end.size == 1 else end.reshape(-1, 1) for end in ends))


def _box_bends(
    evaluator: BendEvaluator, lo: Array, hi: Array, cells: Interval, params: Mapping[str, Interval]
) -> Array:
    """How hard the root may bend down in each box, (n,)."""
    each, count = cells.lo.shape[1], lo.shape[1]
    box = Interval(np.repeat(lo, each, axis=1), np.repeat(hi, each, axis=1))
    value, bend = evaluator(box, Interval(np.tile(cells.lo, count), np.tile(cells.hi, count)), params)
    down = np.where(value.hi < 0.0, 0.0, np.maximum(-bend.lo, 0.0))
    worst: Array = np.broadcast_to(down, (each * count,)).reshape(count, each).max(axis=1)
    return worst


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
