"""What a screen shows of linear radiance, in NumPy, by the formulas that the shaders use."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sdfc.field.graph import FieldGraph
from sdfc.shade.tone import encode_srgb, tone_map

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdfc.field.numeric import Evaluator

_WORTH_TWO = 200_000  # numbers: fewer are done before a second thread is


def present(radiance: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Tone mapped, sRGB, uint8 (height, width, 3), of linear radiance (height, width, 3)."""
    rows = np.asarray(radiance, np.float32)
    if rows.size < _WORTH_TWO:
        return _presented(rows)
    with ThreadPoolExecutor(2) as both:  # NumPy lets go of the interpreter while it computes
        return np.concatenate(list(both.map(_presented, np.array_split(rows, 2))))


def _presented(radiance: NDArray[np.float32]) -> NDArray[np.uint8]:
    color = radiance.reshape(-1, 3).T
    for evaluator in _evaluators():
        (color,) = evaluator({"color": color})
    encoded = np.nan_to_num(color).T.reshape(radiance.shape)
    return np.round(np.clip(encoded, 0.0, 1.0) * 255.0).astype(np.uint8)


@cache
def _evaluators() -> tuple[Evaluator, ...]:
    """Tone mapping, then sRGB's curve; in float32, whose rounding is far below what eight bits keep."""
    from sdfc.field.numeric import Evaluator

    graph = FieldGraph()
    return tuple(Evaluator([build(graph).result], np.float32) for build in (tone_map, encode_srgb))
