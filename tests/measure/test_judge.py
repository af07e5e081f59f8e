"""Law: a picture made from the truth is right, and each way of being wrong is seen as that and as nothing else."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from truth import Picture, compiled_text, judge, perfect, random_rays, truth_of, unanswered

from sdfc.measure.judge import Judgement
from sdfc.measure.truth import Truth
from sdfc.pipeline import Compiled

CONE = (0.0, 5e-3)
SCENE = "scene { box(size: [1.2, 1, 0.9]) - sphere(radius: 0.56) | sphere(radius: 0.2).translate([0.8, 0, 0]) }"


@pytest.fixture(scope="module")
def case() -> tuple[Compiled, Picture, Truth]:
    """A scene, what a tracer without error answers, and the truth."""
    compiled, picture = compiled_text(SCENE), unanswered(*random_rays(1500, 3))
    truth = truth_of(compiled, picture, CONE, cache=False)
    return compiled, perfect(picture, truth), truth


def some_hits(truth: Truth, count: int) -> np.ndarray:
    return np.flatnonzero(truth.hit & truth.sure & ~truth.crease)[:count]


def verdicts(found: Judgement) -> tuple[int, int, int, int, int]:
    sure = found.sure
    return sure.missed, sure.false, sure.early, sure.late, found.not_a_number


def test_the_truth_is_right(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    found = judge(compiled, picture, truth, CONE)
    assert found.correct and verdicts(found) == (0, 0, 0, 0, 0)
    assert found.sure.hits > 400
    assert found.normal.maximum == 0.0 and found.comparison.error.maximum < 1e-10
    assert found.by_both == 1500 and found.by_events == found.by_intervals == 0
    assert found.comparison.residual is not None and found.comparison.residual.maximum < 1e-10


def test_hits_that_are_dropped_are_missed(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    hit = picture.hit.copy()
    hit[some_hits(truth, 5)] = False
    found = judge(compiled, replace(picture, hit=hit), truth, CONE)
    assert verdicts(found) == (5, 0, 0, 0, 0) and not found.correct


def test_hits_that_are_made_up_are_false(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    index = np.flatnonzero(~truth.hit & truth.sure)[:4]
    hit, depth, normal = picture.hit.copy(), picture.depth.copy(), picture.normal.copy()
    hit[index], depth[index], normal[:, index] = True, 2.0, 1.0
    found = judge(compiled, replace(picture, hit=hit, depth=depth, normal=normal), truth, CONE)
    assert verdicts(found) == (0, 4, 0, 0, 0) and not found.correct


@pytest.mark.parametrize(("shift", "expected"), [(-0.05, (0, 0, 7, 0, 0)), (0.05, (0, 0, 0, 7, 0))])
def test_depths_that_are_shifted_are_early_or_late(
    case: tuple[Compiled, Picture, Truth], shift: float, expected: tuple[int, ...]
) -> None:
    compiled, picture, truth = case
    depth = picture.depth.copy()
    depth[some_hits(truth, 7)] += shift
    found = judge(compiled, replace(picture, depth=depth), truth, CONE)
    assert verdicts(found) == expected and not found.correct
    assert found.comparison.error.maximum == pytest.approx(0.05)


def test_a_shift_of_a_pixel_is_a_pixel(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    at_eye, growth = 1e-3, 5e-3
    shifted = replace(picture, depth=picture.depth + 2.0 * (at_eye + growth * truth.t))
    found = judge(compiled, shifted, truth, (at_eye, growth))
    assert found.comparison.error_pixels.median == pytest.approx(1.0, abs=1e-6)
    assert found.comparison.error_pixels.maximum == pytest.approx(1.0, abs=1e-6)


def test_numbers_that_are_none_are_counted(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    depth, normal = picture.depth.copy(), picture.normal.copy()
    first, second, third = some_hits(truth, 3)
    depth[first] = np.nan
    normal[1, [first, second, third]] = np.nan
    found = judge(compiled, replace(picture, depth=depth, normal=normal), truth, CONE)
    assert found.not_a_number == 3 and not found.correct
    assert found.normal.maximum == 0.0  # of the others


def test_normals_are_compared_as_angles_whatever_their_lengths(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    normal = picture.normal.copy()
    index = some_hits(truth, 1)
    side = np.cross(normal[:, index], normal[[1, 2, 0]][:, index], axis=0)
    side /= np.linalg.norm(side, axis=0)
    normal[:, index] = 7.0 * (np.cos(0.3) * normal[:, index] + np.sin(0.3) * side)
    found = judge(compiled, replace(picture, normal=normal), truth, CONE)
    assert found.normal.maximum == pytest.approx(np.degrees(0.3)) and found.normal.median == 0.0


def test_a_crease_has_no_right_normal(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    common = np.flatnonzero(truth.hit & truth.sure & ~truth.crease)
    crease = truth.crease.copy()
    crease[common[:3]] = True
    normal = picture.normal.copy()
    normal[:, common[:3]] *= -1.0
    found = judge(compiled, replace(picture, normal=normal), replace(truth, crease=crease), CONE)
    assert found.normal.maximum == 0.0
    assert found.creases == int((crease & truth.hit & truth.sure).sum()) >= 3


def test_effort_and_stalls(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    hits, misses = np.flatnonzero(truth.hit)[:2], np.flatnonzero(~truth.hit)[:3]
    unfinished = np.zeros(1500, bool)
    unfinished[hits], unfinished[misses] = True, True
    busy = replace(picture, steps=np.arange(1500.0), unfinished=unfinished)
    found = judge(compiled, busy, truth, CONE, evaluations=np.full(1500, 6.0))
    assert (found.stalls.hits, found.stalls.misses) == (2, 3)
    assert (found.steps.mean, found.steps.p99, found.steps.most) == (749.5, 1485.0, 1499.0)
    assert found.evaluations is not None and found.evaluations.mean == found.evaluations.most == 6.0
    assert judge(compiled, busy, truth, CONE).evaluations is None


def test_a_judgement_is_plain_json(case: tuple[Compiled, Picture, Truth]) -> None:
    compiled, picture, truth = case
    for found in (
        judge(compiled, picture, truth, CONE),
        judge(compiled, replace(picture, hit=np.zeros(1500, bool)), truth, CONE),  # there are no errors of no hits
    ):
        told = json.loads(json.dumps(found.as_json(), allow_nan=False))
        assert told["correct"] == found.correct
        assert told["comparison"]["sure"] == asdict(found.sure)
        assert "hits" in str(found)
    assert told["normal"] == {"median": None, "p99": None, "maximum": None}
