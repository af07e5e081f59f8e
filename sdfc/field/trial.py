"""Rays tried in float64 before a rule is chosen: how many steps to the surface by empty balls, and by parabolas too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sdfc.field.derivative import directional
from sdfc.field.graph import Expr
from sdfc.field.numeric import Evaluator

Array = NDArray[np.float64]

RAYS = 256
MOST = 60  # steps: what takes longer is long either way
NEAR = 1e-5  # of the box: what counts as there


def steps_by_ball_and_parabola(
    value: Expr,
    core: Expr,
    lipschitz: float,
    bend: float,
    lo: Sequence[float],
    hi: Sequence[float],
    params: Mapping[str, ArrayLike],
) -> tuple[float, float]:
    """Mean steps of rays through a box, from all sides: the same rays every time.

    `value` (FLOAT in the VEC3 `p`) has the Lipschitz constant, `core` the bend (sdfc/field/bend).
    """
    random = np.random.default_rng(20)
    low, high = np.array(lo)[:, None], np.array(hi)[:, None]
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    away = random.normal(size=(3, RAYS))
    o = middle + 3.0 * radius * away / np.linalg.norm(away, axis=0)
    d = random.uniform(low, high, (3, RAYS)) - o
    d /= np.linalg.norm(d, axis=0)
    with np.errstate(divide="ignore"):
        ends = (low - o) / d, (high - o) / d
    box = np.minimum(*ends).max(axis=0), np.maximum(*ends).min(axis=0)
    p, direction = value.graph.input("p"), value.graph.input("d")
    evaluate = Evaluator([value, core, directional(core, {p: direction})])

    def mean(with_parabola: bool) -> float:
        t, on_way, taken = box[0].copy(), np.arange(RAYS), 0
        for _ in range(MOST):
            if not on_way.size:
                break
            there = {"p": o[:, on_way] + t[on_way] * d[:, on_way], "d": d[:, on_way]}
            f, g, slope = (np.broadcast_to(a, on_way.shape) for a in evaluate(there, params))
            taken += on_way.size
            ball = f / lipschitz
            both = np.maximum(ball, _root(np.maximum(g, 0.0), slope, bend))
            # as near for the one as for the other: where a field is far flatter than its constant, a small ball is not
            near = both <= NEAR * radius
            t[on_way] += np.maximum(both if with_parabola else ball, 0.0)
            on_way = on_way[~near & (t[on_way] < box[1][on_way])]
        return taken / RAYS

    return mean(False), mean(True)


def _root(above: Array, slope: Array, bend: float) -> Array:
    """Where above + slope x - bend x x / 2 comes down to 0."""
    root = np.sqrt(slope * slope + 2.0 * bend * above)
    falling = slope < 0.0
    return np.where(falling, 2.0 * above / np.where(falling, root - slope, 1.0), (slope + root) / bend)
