"""Cases traced in one way, and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.measure.judge import footprint
from sdfc.measure.picture import Picture, Tracing
from sdfc.measure.stress.record import Case
from sdfc.measure.truth import truth_of
from sdfc.pipeline import Compiled
from sdfc.plan.plan import FINE, HORIZON, SMALLEST_TOLERANCE
from sdfc.plan.steps import is_closed
from sdfc.reference.certify import Certificate, Status
from sdfc.reference.compare import SLACK_ULPS

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

ROWS = 100_000  # pictures are small, but judged as finely as one of so many rows


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """What was answered in one case; rays flat, rows from the top.

    `truth` is of these rays. `kinds`: for each way to break the guarantee, the rays that do. `pixel`: half of one,
    where the ray hit.
    """

    case: Case
    size: tuple[int, int]
    picture: Picture
    truth: Certificate
    kinds: dict[str, Mask]
    pixel: Array

    @property
    def failures(self) -> dict[str, int]:
        """How many rays break the guarantee, by how."""
        return {kind: int(mask.sum()) for kind, mask in self.kinds.items() if mask.any()}

    @property
    def wrong(self) -> Mask:
        """The rays that break it."""
        return cast(Mask, np.logical_or.reduce(list(self.kinds.values())))

    @property
    def sure(self) -> Mask:
        """Rays on which there is no excuse."""
        return cast(Mask, ~self.truth.contested & (self.truth.status != Status.AMBIGUOUS))

    @property
    def error(self) -> Array:
        """|t - t*| of the uncontested hits, in the scene's own unit (its radius)."""
        return _error(self.picture, self.truth)[_both(self.picture, self.truth)]

    @property
    def error_pixels(self) -> Array:
        """The same in half pixels."""
        return self.error / np.maximum(self.pixel[_both(self.picture, self.truth)], 1e-30)


@dataclass(frozen=True, slots=True, eq=False)
class _Drawn:
    """A case's picture, before it is judged."""

    case: Case
    size: tuple[int, int]
    picture: Picture
    near: Array  # what counts as touching, per ray: powers of two, so that few are different
    pixel: Array  # half of one
    end: float  # how far rays are traced


@pipeline.deep_recursion()
def tried(tracing: Tracing, compiled: Compiled, cases: Sequence[Case], size: tuple[int, int]) -> list[Trial]:
    """Cases of one scene, drawn and judged: all rays together, for a proof of many rays at once is cheap."""
    groups: dict[str, list[_Drawn]] = {}
    for case in cases:
        groups.setdefault(repr(sorted(case.params.items())), []).append(_drawn(tracing, compiled, case, size))
    found = {id(trial.case): trial for group in groups.values() for trial in _judged(compiled, group)}
    return [found[id(case)] for case in cases]


def _drawn(tracing: Tracing, compiled: Compiled, case: Case, size: tuple[int, int]) -> _Drawn:
    pixels = case.pixels(size)
    finer = max(1.0, ROWS / pixels[1])
    picture = tracing.picture(compiled, pixels, case.view, dict(case.params), finer)
    at_eye, growth = footprint(compiled, pixels, case.view)
    t = np.where(picture.hit & np.isfinite(picture.depth), picture.depth, 0.0)
    reach = np.linalg.norm(picture.o, axis=0).max() + 1.0
    pixel = (at_eye + growth * np.maximum(t, reach)) / finer
    out = np.linalg.norm(picture.o + t * picture.d, axis=0)
    rounding = SMALLEST_TOLERANCE * np.maximum(1.0, np.where(t > 0.0, out, 0.0))
    exact = compiled.plan.tracer.needs_steps and is_closed(compiled.plan.root)
    near = rounding if exact else np.maximum(2.0 * rounding, FINE * pixel)  # what is marched and cut is sunk by three
    end = np.inf if exact or compiled.frame.is_finite else 0.5 * HORIZON
    return _Drawn(case, pixels, picture, 2.0 ** np.ceil(np.log2(near)), (at_eye + growth * t) / finer, end)


def _judged(compiled: Compiled, group: list[_Drawn]) -> list[Trial]:
    truth = _truth(compiled, group)
    trials, first = [], 0
    for drawn in group:
        part = _some(truth, slice(first, first + drawn.picture.hit.size))
        part.contested[:] |= (part.status == Status.HIT) & (part.t_lo > drawn.end)
        first += drawn.picture.hit.size
        trials.append(Trial(drawn.case, drawn.size, drawn.picture, part, _kinds(drawn.picture, part), drawn.pixel))
    return trials


@np.errstate(all="ignore")
def _truth(compiled: Compiled, group: list[_Drawn]) -> Certificate:
    """Of all rays of pictures with the same params, each with its own tolerance."""
    joined = _joined([drawn.picture for drawn in group])
    near = np.concatenate([drawn.near for drawn in group])
    levels = {level: np.flatnonzero(near == level) for level in np.unique(near)}
    parts = []
    for level, index in levels.items():
        pixel = (level / FINE, 0.0)
        parts.append(truth_of(compiled, joined.some(index), pixel, params=group[0].case.params).certificate)
    back = np.argsort(np.concatenate(list(levels.values())), kind="stable")
    return Certificate(*(np.concatenate([getattr(p, name) for p in parts])[back] for name in Certificate.__slots__))


def _joined(pictures: list[Picture]) -> Picture:
    return Picture(*(np.concatenate([getattr(p, name) for p in pictures], axis=-1) for name in Picture.__slots__))


def _some(truth: Certificate, index: slice) -> Certificate:
    return Certificate(*(getattr(truth, name)[index] for name in Certificate.__slots__))


def _both(picture: Picture, truth: Certificate) -> Mask:
    """Uncontested rays that hit, and should."""
    both: Mask = picture.hit & (truth.status == Status.HIT) & ~truth.contested & np.isfinite(picture.depth)
    return both


def _error(picture: Picture, truth: Certificate) -> Array:
    with np.errstate(invalid="ignore"):
        return np.abs(picture.depth - 0.5 * (truth.t_lo + truth.t_hi))


def _kinds(picture: Picture, truth: Certificate) -> dict[str, Mask]:
    sure = ~truth.contested & (truth.status != Status.AMBIGUOUS)
    solid = truth.status == Status.HIT
    both = _both(picture, truth)
    t = np.where(both, picture.depth, 0.0)
    far = np.spacing(np.maximum(np.abs(picture.o).max(axis=0), np.abs(t)).astype(np.float32))
    near = np.spacing(np.maximum(1.0, np.abs(picture.o + t * picture.d).max(axis=0)).astype(np.float32))
    slack = (
        SLACK_ULPS * near + 2.0 * far
    )  # of where the hit is; and a depth that is counted from the eye has its own ulp
    early = np.minimum(truth.t_early, truth.t_lo) - slack
    late = np.maximum(np.where(np.isfinite(truth.t_late), truth.t_late, truth.t_hi), truth.t_hi) + slack
    numbers = np.isfinite(picture.steps) & np.isfinite(picture.normal).all(axis=0)
    return {
        "missed": sure & solid & ~picture.hit,
        "false": sure & ~solid & picture.hit,
        "early": both & (t < early),
        "late": both & (t > late),
        "not a number": ~numbers | (picture.hit & ~np.isfinite(picture.depth)),
        "given up": picture.unfinished,
    }
