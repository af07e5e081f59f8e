"""Answers held against what is proved of their rays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from sdfc import pipeline
from sdfc.field.order import evaluation_order
from sdfc.measure import judge as judging
from sdfc.measure.bench.answers import Answers, Array, Index, RayDrawing, Rays, Size, random_pixels
from sdfc.measure.bench.record import Errors, Spread
from sdfc.measure.picture import Picture
from sdfc.measure.truth import Truth, truth_of
from sdfc.pipeline import Compiled
from sdfc.reference import compare
from sdfc.shape.lower import lower

FEWEST = 500  # rays, however dear their truth is


@dataclass(frozen=True, slots=True, eq=False)
class Court:
    """A set of rays of a scene, and their truth. It does not depend on a cell's tolerance:

    rays are contested by what sdfc asks for (tolerance 1), and what a coarser one answers wrongly counts as wrong.
    """

    compiled: Compiled
    size: Size
    index: Index | None  # of the picture's rays; None: all
    cone: tuple[float, float]  # half a pixel: at the eye, and its growth with t
    unanswered: Picture
    truth: Truth

    def judge(self, image: Answers, normals: Array | None = None) -> Errors:
        """The errors of a picture of this court's size; `normals` (3, n), where they were drawn."""
        answers = image if self.index is None else image.some(self.index)
        picture = replace(
            self.unanswered,
            hit=answers.hit,
            depth=answers.depth,
            steps=answers.steps,
            unfinished=answers.given_up,
            normal=self.unanswered.normal if normals is None else self._chosen(normals),
        )
        found = judging.judge(self.compiled, picture, self.truth, self.cone)
        sure, contested = found.sure, found.comparison.contested
        assert found.comparison.residual is not None
        return Errors(
            rays=sure.rays,
            hits=sure.hits,
            missed=sure.missed,
            false=sure.false,
            early=sure.early,
            late=sure.late,
            not_finite=found.not_a_number,
            stalls=int((answers.given_up & self.truth.sure).sum()),
            contested=contested.rays,
            contested_wrong=contested.missed + contested.false + contested.early + contested.late,
            ambiguous=found.comparison.ambiguous,
            mean_pixels=self._mean_pixels(answers),
            pixels=_spread(found.comparison.error_pixels),
            ulps=_spread(found.comparison.error_ulps),
            residual=_spread(found.comparison.residual),
            normals=Spread() if normals is None else _spread(found.normal),
        )

    def cover(self, hit: Answers) -> Errors:
        """Of a picture that says only what was hit."""
        answers = hit if self.index is None else hit.some(self.index)
        sure, contested = self.truth.sure, self.truth.certificate.contested
        wrong = self.truth.hit != answers.hit
        return Errors(
            rays=int(sure.sum()),
            hits=int((sure & self.truth.hit).sum()),
            missed=int((sure & wrong & self.truth.hit).sum()),
            false=int((sure & wrong & answers.hit).sum()),
            contested=int(contested.sum()),
            contested_wrong=int((contested & wrong).sum()),
            ambiguous=int((~sure & ~contested).sum()),
        )

    def _chosen(self, values: Array) -> Array:
        return values if self.index is None else values[:, self.index]

    def _mean_pixels(self, answers: Answers) -> float:
        """Over the uncontested rays that hit in both."""
        both = answers.hit & self.truth.hit & self.truth.sure & np.isfinite(answers.depth)
        exact = self.truth.t[both]
        pixel = np.maximum(2.0 * (self.cone[0] + self.cone[1] * exact), np.finfo(np.float64).tiny)
        return float(np.mean(np.abs(answers.depth[both] - exact) / pixel)) if both.any() else float("nan")


def _spread(given: compare.Spread) -> Spread:
    return Spread(given.median, given.p99, given.maximum)


def court(compiled: Compiled, drawing: RayDrawing, size: Size, count: int | None = None, most: float = inf) -> Court:
    """The truth about every ray of a picture, or about `count` random ones.

    `most`: nodes of the field times rays; where it is less, about so many random ones (but FEWEST).
    """
    rays = drawing.rays(compiled, size)
    total = size[0] * size[1] if count is None else count
    affordable = max(FEWEST, most / _nodes(compiled))
    count = int(affordable) if affordable < total else count
    index = None if count is None else random_pixels(size, count)
    picture = _unanswered(rays if index is None else Rays(rays.o[:, index], rays.d[:, index]))
    cone = judging.footprint(compiled, size)
    return Court(compiled, size, index, cone, picture, truth_of(compiled, picture, cone))


def _nodes(compiled: Compiled) -> int:
    """Of the field as truth has it."""
    with pipeline.deep_recursion():
        return len(evaluation_order([lower(compiled.shape, compiled.scene.values.input("p"))]))


def _unanswered(rays: Rays) -> Picture:
    """The rays as judges take them."""
    count = rays.o.shape[1]
    none, nothing = np.zeros(count, bool), np.zeros(count)
    return Picture(rays.o, rays.d, none, nothing, np.zeros((3, count)), nothing, nothing, none)
