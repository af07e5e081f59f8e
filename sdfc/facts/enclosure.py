"""A box for a formula that claims none: intervals prove that it is larger than the level beyond each face."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdfc.facts.box import Box
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Expr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_DISTANCES = tuple(2.0**k for k in range(-6, 21))
_CUTS = 64  # positions tried for a face in the second round


def enclosing(root: Expr, dimension: int, level: float, ranges: Ranges) -> Box:
    """A box that holds {root <= level} for every value of the params; `root` is a FLOAT in the INPUT `p`.

    First whole half-spaces beyond powers of two; then, within the box so found, slabs below its faces.
    """
    import numpy as np

    from sdfc.field.interval import IntervalEvaluator

    evaluator = IntervalEvaluator(root)

    def is_beyond(lo: NDArray[np.float64], hi: NDArray[np.float64]) -> NDArray[np.bool_]:
        low, _ = evaluator.value({"p": (lo, hi)}, dict(ranges.of))
        return np.broadcast_to(np.asarray(low) > level, lo.shape[1:])

    corner = np.full(dimension, np.inf)
    low, high = -corner, corner
    for first in (True, False):
        new_low, new_high = low.copy(), high.copy()
        for axis in range(dimension):
            for side in (-1, 1):
                ends = _positions(low[axis], high[axis], side, first)
                lo, hi = (np.repeat(end[:, None], len(ends), axis=1) for end in (low, high))
                (lo if side > 0 else hi)[axis] = ends
                proved = ends[is_beyond(lo, hi)]
                if side > 0:
                    new_high[axis] = min(high[axis], proved.min(initial=np.inf))
                else:
                    new_low[axis] = max(low[axis], proved.max(initial=-np.inf))
        low, high = new_low, new_high
        if (low > high).any():
            break
    return Box(tuple(low.tolist()), tuple(high.tolist()))


def _positions(low: float, high: float, side: int, first: bool) -> NDArray[np.float64]:
    """Where a face may be put."""
    import numpy as np

    if first:
        powers = np.array(_DISTANCES)
        return np.concatenate([-powers, [0.0], powers])
    if not np.isfinite([low, high]).all():
        return np.array([high if side > 0 else low])
    return np.linspace(low, high, _CUTS)
