"""The metrics, on answers whose errors are known."""

import numpy as np
import pytest

from sdfc.field.graph import FieldGraph
from sdfc.reference.certify import Certificate, Status, first_roots
from sdfc.reference.compare import Spread, compare


def truth(count: int = 1000) -> Certificate:
    """Parallel rays over a unit ball, half of them past it."""
    graph = FieldGraph()
    o = np.stack([np.linspace(0.0, 2.0, count), np.zeros(count), np.full(count, -3.0)])
    d = np.repeat(np.array([[0.0], [0.0], [1.0]]), count, axis=1)
    return first_roots(graph.length(graph.input("p")) - 1.0, o, d, 0.0, 10.0, tolerance=1e-5, thin=1e-7)


def test_the_truth_itself_has_no_error() -> None:
    exact = truth()
    hit = exact.status == Status.HIT
    result = compare(exact, hit, np.where(hit, exact.t_lo, np.inf), 1e-3)
    assert result.correct and result.sure.hits == hit.sum() == 500
    assert result.error.maximum < 1e-10 and result.error_ulps.maximum < 1e-3
    assert "500 hits: 0 missed, 0 false" in str(result) and "Residual" not in str(result)


def test_each_kind_of_error_is_counted_once() -> None:
    exact = truth()
    hit = exact.status == Status.HIT
    t = np.where(hit, exact.t_lo, np.inf)
    hit[3], t[3] = False, np.inf
    hit[900], t[900] = True, 4.0
    t[5] -= 1e-2
    t[6] += 2e-2
    t[7] = np.nan
    result = compare(exact, hit, t, 1e-3, residual=np.full(1000, -1e-6))
    sure = result.sure
    assert (sure.missed, sure.false, sure.early, sure.late, result.not_finite) == (1, 1, 1, 1, 1)
    assert not result.correct
    assert result.error.maximum == pytest.approx(2e-2) and result.error.median < 1e-10
    assert result.error_pixels.maximum == pytest.approx(2e-2 / (1e-3 * exact.t_lo[6]))
    assert result.error_ulps.maximum == pytest.approx(2e-2 / 2.0**-22, rel=1e-3)
    assert result.residual is not None and result.residual.maximum == 1e-6
    assert "1 missed, 1 false, 1 early, 1 late, 1 not finite" in str(result)


def test_contested_and_ambiguous_rays_are_kept_apart() -> None:
    count = 4
    status = np.array([Status.HIT, Status.MISS, Status.AMBIGUOUS, Status.HIT], np.int8)
    t = np.where(status == Status.HIT, 2.0, np.inf)
    contested = np.array([True, True, True, False])
    exact = Certificate(status, t, t, np.zeros(count), t, t, contested)
    result = compare(exact, np.array([False, True, True, True]), np.array([np.inf, 2.0, 2.0, 2.0]), 1e-3)
    assert result.correct and result.ambiguous == 1
    assert (result.contested.rays, result.contested.missed, result.contested.false) == (2, 1, 1)
    assert result.sure.rays == 1


def test_within_the_tolerance_is_neither_early_nor_late() -> None:
    exact = truth()
    hit = exact.status == Status.HIT
    for t in (exact.t_early, exact.t_late):
        assert compare(exact, hit, np.where(hit, t, np.inf), 1e-3).correct


def test_spreads() -> None:
    spread = Spread.of(np.arange(1000.0))
    assert (spread.median, spread.p99, spread.maximum) == (500.0, 990.0, 999.0)
    assert np.isnan(Spread.of(np.zeros(0)).maximum)
