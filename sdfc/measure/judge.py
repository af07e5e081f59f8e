"""A traced picture against what is proved of its very rays, in the scene's own coordinates (its unit is its radius)."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.api.request import View
from sdfc.field.numeric import Evaluator
from sdfc.measure.picture import Picture
from sdfc.pipeline import Compiled
from sdfc.plan.plan import FINE, SMALLEST_TOLERANCE
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.certify import Certificate, first_roots
from sdfc.reference.compare import Comparison, compare
from sdfc.shape.lower import lower

Array: TypeAlias = NDArray[np.float64]

THIN = 3e-6  # of the radius: thinner runs of solid are films. The tracer's skins are 2.4e-7 and 9.5e-7
FAR = 1e9  # the tracer's own end of the world


def footprint(compiled: Compiled, size: tuple[int, int], view: View = View()) -> tuple[float, float]:  # noqa: B008
    """Half a pixel: its size at the eye, and its growth with t."""
    half: Any = compiled.uniforms(view, {}, size)["pixel"]
    return float(half[0]), float(half[1])


def tolerance(compiled: Compiled, picture: Picture, cone: tuple[float, float]) -> float:
    """Twice what the tracer takes for touching at the far side of the scene (ALGORITHMS: contested is within 2 eps).

    As a value of the field: one that is no distance, with Lipschitz constant L, may be L eps at a distance of eps.
    """
    reach = float(np.linalg.norm(picture.o, axis=0).max()) + 1.0
    slope = max([1.0, *(leaf.lipschitz for leaf in leaves_of(compiled.plan.root) if isinstance(leaf, Ball))])
    return 2.0 * slope * max(SMALLEST_TOLERANCE, FINE * (cone[0] + cone[1] * reach))


def certified(compiled: Compiled, picture: Picture, near: float, end: float | None = None) -> Certificate:
    """What is proved of the picture's rays; the scene as it is after all passes."""
    reach = np.linalg.norm(picture.o, axis=0) + 1.01
    params = {p.name: p.default for p in compiled.scene.params}
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        last = end if end is not None else (reach if compiled.frame.is_finite else FAR)
        return first_roots(distance, picture.o, picture.d, 0.0, last, params, thin=THIN, tolerance=near)


def verdict(compiled: Compiled, picture: Picture, truth: Certificate, cone: tuple[float, float]) -> Comparison:
    """The picture held against its truth, with the residual of its hits in the scene's own unit."""
    params = {p.name: p.default for p in compiled.scene.params}
    residual = np.zeros(picture.hit.size)
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        (values,) = Evaluator([distance])({"p": picture.points}, params)
    residual[picture.hit] = np.broadcast_to(values, picture.hit.sum())
    scale = np.abs(picture.o).max(axis=0, initial=0.0)
    depth = np.where(picture.hit, picture.depth, np.inf)
    return compare(truth, picture.hit, depth, 2.0 * max(cone), origin_scale=scale, residual=residual)


def wrong(picture: Picture, truth: Certificate) -> NDArray[np.intp]:
    """The indices of uncontested rays that were missed or hit falsely."""
    sure = ~truth.contested & (truth.status != 2)
    return np.flatnonzero(sure & ((truth.status == 1) != picture.hit))
