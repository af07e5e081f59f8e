"""A traced picture against what is proved of its very rays, in the scene's own coordinates (its unit is its radius)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.api.request import View
from sdfc.field.derivative import gradient
from sdfc.field.numeric import Evaluator
from sdfc.measure.picture import Picture
from sdfc.pipeline import Compiled
from sdfc.plan.plan import FINE, SMALLEST_TOLERANCE
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.certify import Certificate, first_roots
from sdfc.reference.compare import Comparison, Counts, Spread, compare
from sdfc.shape.lower import lower

if TYPE_CHECKING:
    from sdfc.measure.truth import Truth

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Params: TypeAlias = Mapping[str, tuple[float, ...]]

THIN = 3e-6  # of the radius: thinner runs of solid are films. The tracer's skins are 2.4e-7 and 9.5e-7
FAR = 1e9  # the tracer's own end of the world


@dataclass(frozen=True, slots=True)
class Effort:
    """How many a ray: mean, 99th percentile, most."""

    mean: float
    p99: float
    most: float

    @classmethod
    def of(cls, counts: Array) -> Effort:
        if counts.size == 0:
            return cls(np.nan, np.nan, np.nan)
        p99 = float(np.quantile(counts, 0.99, method="higher"))
        return cls(float(counts.mean()), p99, float(counts.max()))


@dataclass(frozen=True, slots=True)
class Stalls:
    """Rays that were given up at the most steps they may take, and what was answered then."""

    hits: int
    misses: int


@dataclass(frozen=True, slots=True)
class Judgement:
    """A picture held against the certified truth (ALGORITHMS D-metrics).

    comparison   Missed, false, early and late, on uncontested rays and on contested ones; how far off the rest is.
    normal       Degrees between the tracer's normal and the true one, on uncontested common hits that are no creases.
    creases      How many of those hits are.
    not_a_number Hits whose depth or normal is not finite.
    stalls       Uncontested or not.
    steps        Passes of the tracer's loops; `evaluations` of the whole scene where they were counted.
    by_events, by_intervals, by_both  How many rays are known by which proof.
    """

    comparison: Comparison
    normal: Spread
    creases: int
    not_a_number: int
    stalls: Stalls
    steps: Effort
    evaluations: Effort | None
    by_events: int
    by_intervals: int
    by_both: int

    @property
    def sure(self) -> Counts:
        """What went wrong where there is no excuse."""
        return self.comparison.sure

    @property
    def correct(self) -> bool:
        """Nothing missed, false, early or late outside contested rays, and every number a number."""
        return self.comparison.correct and self.not_a_number == 0

    def as_json(self) -> dict[str, Any]:
        """Nested plain values; what does not exist (an error of no hits) is None."""
        plain: dict[str, Any] = _without_nan(asdict(self) | {"correct": self.correct})
        return plain

    def __str__(self) -> str:
        return (
            f"{self.comparison} Normals {self.normal} degrees, {self.creases} creases; {self.not_a_number} NaN; "
            f"stalls {self.stalls.hits} hits, {self.stalls.misses} misses; steps {self.steps.mean:.3g}."
        )


def _without_nan(value: Any) -> Any:
    match value:
        case dict():
            return {key: _without_nan(inner) for key, inner in value.items()}
        case float() if not math.isfinite(value):
            return None
        case _:
            return value


def judge(
    compiled: Compiled,
    picture: Picture,
    truth: Truth,
    cone: tuple[float, float],
    *,
    params: Params | None = None,
    evaluations: Array | None = None,
) -> Judgement:
    """Everything about a picture that the truth about its rays can tell.

    `cone`: half a pixel at the eye and its growth with t. `evaluations` (n,): of the scene, where they were counted.
    `params`: live values where they are not the defaults: the same that the picture and the truth were made with.
    """
    comparison = verdict(compiled, picture, truth.certificate, cone, params)
    common = picture.hit & truth.hit & truth.sure
    smooth = np.flatnonzero(common & ~truth.crease)
    off = np.degrees(_angle(picture.normal[:, smooth], truth.normal[:, smooth]))
    finite = np.isfinite(picture.depth) & np.isfinite(picture.normal).all(axis=0)
    proofs = np.bincount(truth.proof, minlength=4)
    return Judgement(
        comparison=comparison,
        normal=Spread.of(off[np.isfinite(off)]),
        creases=int((common & truth.crease).sum()),
        not_a_number=int((picture.hit & ~finite).sum()),
        stalls=Stalls(int((picture.unfinished & picture.hit).sum()), int((picture.unfinished & ~picture.hit).sum())),
        steps=Effort.of(picture.steps),
        evaluations=None if evaluations is None else Effort.of(evaluations.ravel()),
        by_events=int(proofs[1]),
        by_intervals=int(proofs[2]),
        by_both=int(proofs[3]),
    )


def _angle(a: Array, b: Array) -> Array:
    """Between vectors (3, n), in radians, whatever their lengths; right for tiny angles too."""
    with np.errstate(all="ignore"):
        a, b = a / np.linalg.norm(a, axis=0), b / np.linalg.norm(b, axis=0)
    angle: Array = 2.0 * np.arctan2(np.linalg.norm(a - b, axis=0), np.linalg.norm(a + b, axis=0))
    return angle


def footprint(compiled: Compiled, size: tuple[int, int], view: View = View()) -> tuple[float, float]:  # noqa: B008
    """Half a pixel: its size at the eye, and its growth with t."""
    half: Any = compiled.uniforms(view, {}, size)["pixel"]
    return float(half[0]), float(half[1])


def near_enough(compiled: Compiled, picture: Picture, cone: tuple[float, float]) -> float:
    """What a tracer takes for touching at the far side of the scene, as a length."""
    reach = float(np.linalg.norm(picture.o, axis=0).max()) + 1.0
    return max(SMALLEST_TOLERANCE, FINE * (cone[0] + cone[1] * reach))


def tolerance(compiled: Compiled, picture: Picture, cone: tuple[float, float]) -> float:
    """Twice what the tracer takes for touching at the far side of the scene (ALGORITHMS: contested is within 2 eps).

    As a value of the field: one that is no distance, with Lipschitz constant L, may be L eps at a distance of eps. What
    is not stepped by balls alone goes by the slope near by: there it is that at the hits, so that |dt| is judged.
    """
    balls = [leaf for leaf in leaves_of(compiled.plan.root) if isinstance(leaf, Ball)]
    slopes = [leaf.lipschitz for leaf in balls if leaf.bend is None and not leaf.ahead]
    slopes.append(1.0 if len(slopes) == len(balls) else _steepness(compiled, picture))
    return 2.0 * max(slopes) * near_enough(compiled, picture, cone)


def _steepness(compiled: Compiled, picture: Picture) -> float:
    """How steep the scene's field is at the picture's hits, but for the steepest; 1 where nothing is hit."""
    if not picture.hit.any():
        return 1.0
    params = {p.name: p.default for p in compiled.scene.params}
    with pipeline.deep_recursion():
        p = compiled.scene.values.input("p")
        (slope,) = Evaluator([gradient(lower(compiled.shape, p), p)])({"p": picture.points}, params)
    steep = np.linalg.norm(np.broadcast_to(slope, (3, int(picture.hit.sum()))), axis=0)
    return float(np.quantile(steep[np.isfinite(steep)], 0.95)) if np.isfinite(steep).any() else 1.0


def certified(compiled: Compiled, picture: Picture, near: float, end: float | None = None) -> Certificate:
    """What intervals alone prove of the picture's rays, not kept; `truth_of` is what a judgement needs."""
    reach = np.linalg.norm(picture.o, axis=0) + 1.01
    params = {p.name: p.default for p in compiled.scene.params}
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        last = end if end is not None else (reach if compiled.frame.is_finite else FAR)
        return first_roots(distance, picture.o, picture.d, 0.0, last, params, thin=THIN, tolerance=near)


def verdict(
    compiled: Compiled,
    picture: Picture,
    truth: Certificate,
    cone: tuple[float, float],
    params: Params | None = None,
) -> Comparison:
    """Hits, misses and depths held against a certificate, with the residual of the hits in the scene's own unit."""
    values = {p.name: p.default for p in compiled.scene.params} | dict(params or {})
    residual = np.zeros(picture.hit.size)
    with pipeline.deep_recursion():
        distance = lower(compiled.shape, compiled.scene.values.input("p"))
        (found,) = Evaluator([distance])({"p": picture.points}, values)
    residual[picture.hit] = np.broadcast_to(found, picture.hit.sum())
    scale = np.abs(picture.o).max(axis=0, initial=0.0)
    depth = np.where(picture.hit, picture.depth, np.inf)
    return compare(
        truth, picture.hit, depth, 2.0 * cone[1], at_eye=2.0 * cone[0], origin_scale=scale, residual=residual
    )


def wrong(picture: Picture, truth: Certificate) -> NDArray[np.intp]:
    """The indices of uncontested rays that were missed or hit falsely."""
    sure = ~truth.contested & (truth.status != 2)
    return np.flatnonzero(sure & ((truth.status == 1) != picture.hit))
