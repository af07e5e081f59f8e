"""The float64 truth of hard CSG (sdfc.reference.closed) as tests of tracers ask for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.pipeline import Compiled
from sdfc.reference.certify import Status
from sdfc.reference.closed import closed_roots, is_closed_form

__all__ = ["ClosedTruth", "closed_truth", "is_closed_form"]

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class ClosedTruth:
    """First hits of n rays: of the solid itself, and of all that an error of `near` may make of it.

    A hit belongs in [early, late]. `contested`: see `sdfc.reference.closed.closed_roots`.
    """

    hit: Mask
    t: Array
    early: Array
    late: Array
    contested: Mask


def closed_truth(compiled: Compiled, o: Array, d: Array, near: float, thin: float) -> ClosedTruth:
    """`o`, `d`: (3, n) in the compiled scene's own coordinates; `near` and `thin` are in them too."""
    frame, scene = compiled.frame, compiled.scene
    origin, direction = o * frame.radius + np.array(frame.centre)[:, None], d * frame.radius
    params = {p.name: p.default for p in scene.params}
    with pipeline.deep_recursion():
        truth = closed_roots(
            scene.root,
            scene.values,
            origin,
            direction,
            0.0,
            np.inf,
            params,
            thin=thin,
            tolerance=near * frame.radius,
        )
    middle = np.where(truth.status == Status.HIT, 0.5 * (truth.t_lo + truth.t_hi), np.inf)
    return ClosedTruth(truth.status == Status.HIT, middle, truth.t_early, truth.t_late, truth.contested)
