"""How steep a field is in a box: a bound of its gradient's length, which is a Lipschitz constant there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sdfc.field.cells import Cells
from sdfc.field.graph import Expr, Op, topological
from sdfc.field.interval import IntervalEvaluator, Parameters
from sdfc.field.interval_rules import EPSILON, Array, Interval
from sdfc.field.memory import MEMORY, fingerprint, params_fingerprint

BOXES = 2048  # how many boxes `gradient_bound` looks at
GRID = 6  # its directions: a cube's faces in GRID x GRID cells
_ANYTHING: Parameters = {}


def gradient_bound(
    root: Expr,
    lo: Sequence[float],
    hi: Sequence[float],
    pieces: Sequence[Parameters] = (_ANYTHING,),
    boxes: int = BOXES,
) -> float:
    """An upper bound of |grad root| over the box lo <= p <= hi, so a Lipschitz constant there; inf if none is found.

    `root` is a FLOAT in the INPUT `p` (VEC2 or VEC3). `pieces` together are what the params can be; a PARAM that one
    lacks may be any number. The box is cut, for each piece by itself, where the bound is worst, until `boxes` have been
    looked at or the bound is within 2 % of what is attained. In forward mode, which unlike the reverse-mode gradient
    notices a jump (its gradient is 0 on both sides). Where two kinks meet the hulls of their sides add up: an exact
    box's distance, for one, is bounded by 2.06.
    """

    def search() -> float:
        cells = _Cells(root, lo, hi, pieces)
        while cells.seen < boxes and cells.bounds.max() > 1.02 * cells.attained:
            cells.cut(max(1, (boxes - cells.seen) // 2))
        return float(cells.bounds.max())

    ranges = tuple(params_fingerprint(piece) for piece in pieces)
    return MEMORY.recall(("steepest", fingerprint([root]), tuple(lo), tuple(hi), ranges, boxes), search)


class _Cells(Cells):
    """With a bound of |grad root| in each."""

    def __init__(self, root: Expr, lo: Sequence[float], hi: Sequence[float], pieces: Sequence[Parameters]) -> None:
        self._evaluator = IntervalEvaluator(root)
        self._params = _ranges(root, pieces)
        self._directions, self._cosine = _cover(len(lo))
        self.attained = 0.0  # what |grad| is somewhere
        super().__init__(lo, hi, len(pieces))

    def cut(self, most: int) -> None:
        """Halves the worst boxes, no more than `most`."""
        worst = np.argsort(self.bounds)[::-1][:most]
        largest = self.bounds.max()
        bounds = self.bounds[worst]
        self.halve(worst[bounds >= 0.98 * largest if np.isfinite(largest) else ~np.isfinite(bounds)])

    def bound(self, lo: Array, hi: Array, owner: NDArray[np.int64]) -> Array:
        """An upper bound of |grad| over each box; notes the largest that is attained in one of them."""
        size, count = lo.shape
        each = self._directions.shape[1]
        box = Interval(np.repeat(lo, each, axis=1), np.repeat(hi, each, axis=1))
        rows = np.repeat(owner, each)
        params = {name: Interval(value.lo[..., rows], value.hi[..., rows]) for name, value in self._params.items()}
        slopes = self._evaluator.slope(box, np.tile(self._directions, count), params)
        low, high = (end.reshape(count, -1) for end in slopes)
        attained = np.maximum(np.maximum(low, -high), 0.0).max()
        self.attained = max(self.attained, float(attained) if np.isfinite(attained) else 0.0)
        largest = np.maximum(np.abs(low), np.abs(high))
        by_axes = np.sqrt(np.sum(largest[:, :size] ** 2, axis=1)) * (1.0 + 4.0 * EPSILON)
        by_directions = largest.max(axis=1) / self._cosine
        bounds: Array = np.minimum(by_axes, by_directions)
        return bounds


def _ranges(root: Expr, pieces: Sequence[Parameters]) -> dict[str, Interval]:
    """What each PARAM may be in each piece: a FLOAT's (pieces,), a VECk's (k, pieces)."""
    result = {}
    for node in topological([root]):
        if node.op is Op.PARAM:
            name, size = str(node.value), node.type.size
            given = [np.asarray(piece.get(name, [[-np.inf] * size, [np.inf] * size]), float) for piece in pieces]
            ends = [np.broadcast_to(g.reshape(-1, size), (2, size)) for g in given]
            lo, hi = (np.stack([end[i] for end in ends], axis=-1) for i in (0, 1))
            result[name] = Interval(lo[0], hi[0]) if size == 1 else Interval(lo, hi)
    return result


def _cover(size: int) -> tuple[Array, float]:
    """Unit vectors (size, m), the axes first, and the cosine of the angle within which every line has one of them.

    The derivative along that one is at least that much of |grad|.
    """
    if size == 2:
        angle = np.arange(32) * (np.pi / 32)
        turned = np.stack([np.cos(angle), np.sin(angle)])
        return np.concatenate([np.eye(2), turned], axis=1), float(np.cos(np.pi / 64) - 1e-9)
    ends = np.linspace(-1.0, 1.0, GRID + 1)
    middle = 0.5 * (ends[1:] + ends[:-1])
    u, v = (a.ravel() for a in np.meshgrid(middle, middle))
    face = np.stack([u, v, np.ones_like(u)])
    face /= np.sqrt(np.sum(face * face, axis=0))
    # a cell's farthest point is one of its corners
    cosine = 1.0
    for du in (-1.0 / GRID, 1.0 / GRID):
        for dv in (-1.0 / GRID, 1.0 / GRID):
            corner = np.stack([u + du, v + dv, np.ones_like(u)])
            cosine = min(
                cosine, float((np.sum(corner * face, axis=0) / np.sqrt(np.sum(corner * corner, axis=0))).min())
            )
    faces = [np.roll(face, turn, axis=0) for turn in range(3)]
    return np.concatenate([np.eye(3), *faces], axis=1), cosine - 1e-9
