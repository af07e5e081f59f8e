"""A tracer's answer against the certified truth: what is wrong, and how far off the rest is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.reference.certify import Certificate, Status

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

SLACK_ULPS = 16.0  # float32 ulps of the largest coordinate by which a hit may be outside [t_early, t_late]


@dataclass(frozen=True, slots=True)
class Spread:
    """Median, 99th percentile and maximum of some errors; NaN when there are none."""

    median: float
    p99: float
    maximum: float

    @classmethod
    def of(cls, errors: Array) -> Spread:
        if errors.size == 0:
            return cls(np.nan, np.nan, np.nan)
        median, p99 = np.quantile(errors, [0.5, 0.99], method="higher")
        return cls(float(median), float(p99), float(errors.max()))

    def __str__(self) -> str:
        return f"{self.median:.2g} / {self.p99:.2g} / {self.maximum:.2g}"


@dataclass(frozen=True, slots=True)
class Counts:
    """Rays by what went wrong. `early` and `late` are hits on both sides, but outside the certified window of t."""

    rays: int
    hits: int
    missed: int
    false: int
    early: int
    late: int


@dataclass(frozen=True, slots=True)
class Comparison:
    """Errors of one image. `sure` are the uncontested rays; AMBIGUOUS rays are counted only in `ambiguous`.

    Spreads are over the uncontested rays that hit in both: |t - t*| as a length in t, in pixel footprints and in
    float32 ulps of the largest coordinate of the hit, and |f| at the tracer's hit.
    """

    sure: Counts
    contested: Counts
    ambiguous: int
    not_finite: int
    error: Spread
    error_pixels: Spread
    error_ulps: Spread
    residual: Spread | None

    @property
    def correct(self) -> bool:
        """Nothing wrong on an uncontested ray."""
        sure = self.sure
        return not (sure.missed or sure.false or sure.early or sure.late or self.not_finite)

    def __str__(self) -> str:
        sure, other = self.sure, self.contested
        residual = "" if self.residual is None else f" Residual |f| {self.residual}."
        return (
            f"{sure.rays} uncontested rays, {sure.hits} hits: {sure.missed} missed, {sure.false} false, "
            f"{sure.early} early, {sure.late} late, {self.not_finite} not finite. "
            f"|dt| median / p99 / max {self.error}; in pixels {self.error_pixels}; "
            f"in float32 ulps {self.error_ulps}.{residual} {other.rays} contested rays: "
            f"{other.missed} missed, {other.false} false, {other.early} early, {other.late} late; "
            f"{self.ambiguous} ambiguous."
        )


def compare(
    truth: Certificate,
    hit: Mask,
    t: Array,
    footprint: float,
    *,
    at_eye: float = 0.0,
    origin_scale: float | Array = 0.0,
    residual: Array | None = None,
) -> Comparison:
    """Holds a tracer's `hit` and `t` (n,) against the truth about the same rays.

    `footprint`: how much a pixel's width grows with t; `at_eye`: its width at t = 0. `origin_scale`: the largest
    coordinate of the origins, for the ulps. `residual`: the distance in float64 at the tracer's hits (n,). A hit is
    early before t_early and late after t_late (after t_hi where there is no t_late) by more than SLACK_ULPS.
    """
    decided = truth.status != Status.AMBIGUOUS
    true_hit = truth.status == Status.HIT
    both = hit & true_hit & np.isfinite(t)
    # halfway: a bracket is far narrower than a float32 ulp
    lo, hi = (np.where(true_hit, end, 0.0) for end in (truth.t_lo, truth.t_hi))
    exact = lo + 0.5 * (hi - lo)
    error = np.where(both, np.abs(np.where(both, t, 0.0) - exact), 0.0)
    ulp = _float32_ulp(np.maximum(origin_scale, exact))
    latest = np.where(np.isfinite(truth.t_late), truth.t_late, truth.t_hi)
    early = both & (t < np.minimum(truth.t_early, truth.t_lo) - SLACK_ULPS * ulp)
    late = both & (t > np.maximum(latest, truth.t_hi) + SLACK_ULPS * ulp)

    def counts(among: Mask) -> Counts:
        return Counts(
            rays=int(among.sum()),
            hits=int((among & true_hit).sum()),
            missed=int((among & true_hit & ~hit).sum()),
            false=int((among & ~true_hit & hit).sum()),
            early=int((among & early).sum()),
            late=int((among & late).sum()),
        )

    measured = both & ~truth.contested
    pixel = np.maximum(at_eye + footprint * exact, np.finfo(np.float64).tiny)
    return Comparison(
        sure=counts(decided & ~truth.contested),
        contested=counts(decided & truth.contested),
        ambiguous=int((~decided).sum()),
        not_finite=int((hit & ~np.isfinite(t)).sum()),
        error=Spread.of(error[measured]),
        error_pixels=Spread.of((error / pixel)[measured]),
        error_ulps=Spread.of((error / ulp)[measured]),
        residual=None if residual is None else Spread.of(np.abs(residual[measured])),
    )


def _float32_ulp(x: Array) -> Array:
    return np.spacing(np.maximum(np.abs(x), 1e-30).astype(np.float32)).astype(np.float64)
