"""Law: outside contested pixels the proven tracer misses nothing, invents nothing, and is neither early nor late.

SDFC_FULL=1 asks for 160x90 and every ray; else a spread of them, fewer where the proof is dear.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from closed_truth import closed_truth, is_closed_form
from truth import THIN, Tracing, certified, compiled_file, every, footprint, judge, truth_of, wrong

pytestmark = pytest.mark.gpu

ROOT = Path(__file__).parent.parent.parent
SCENES = sorted(p for p in (ROOT / "scenes").iterdir() if p.suffix in (".sdf", ".csg"))
MODELS = sorted((ROOT.parent / "shared" / "models").glob("*.csg"))

# rays that are proved in a short run: interval arithmetic over hundreds of parts takes its time
FEW = {"chess.sdf": 60, "city.sdf": 60, "spheres.sdf": 60, "temple.sdf": 60, "example024.csg": 60}
USUAL = 120
ULP = 2.0**-23
EXACT = 1e-5  # of a pixel's footprint in a picture of 160x90: half of all hits on hard CSG are nearer than that


def name(path: Path) -> str:
    return path.name


@pytest.mark.parametrize("path", SCENES + MODELS, ids=name)
def test_against_interval_arithmetic(path: Path, tracing: Tracing, is_full: bool) -> None:
    size = (160, 90) if is_full else (80, 45)
    compiled = compiled_file(path)
    picture = tracing.picture(compiled, size)
    assert np.isfinite(picture.steps).all() and np.isfinite(picture.depth[picture.hit]).all()
    some = every(picture, size[0] * size[1] if is_full else FEW.get(path.name, USUAL))
    cone = footprint(compiled, size)
    truth = truth_of(compiled, some, cone, cache=False)
    result = judge(compiled, some, truth, cone)
    print(f"{path.name}: {result}")
    bad = wrong(some, truth.certificate)
    assert result.correct, f"{result}\nfirst wrong rays: o {some.o[:, bad[:3]].T}, d {some.d[:, bad[:3]].T}"
    assert truth.sure.mean() > 0.9
    assert result.stalls.hits == result.stalls.misses == 0
    if result.sure.hits:
        residual = result.comparison.residual
        assert residual is not None and residual.maximum < truth.tolerance


@pytest.mark.parametrize("path", SCENES + MODELS, ids=name)
def test_hard_csg_against_merged_intervals(path: Path, tracing: Tracing, is_full: bool) -> None:
    """Many more rays. To a few ulps, which is far less than a tolerance of marching; half of them to less than one."""
    compiled = compiled_file(path)
    if not is_closed_form(compiled.scene.root):
        pytest.skip("not all parts have ray intervals in closed form: interval arithmetic alone judges it")
    picture = tracing.picture(compiled, (160, 90) if is_full else (80, 45))
    picture = every(picture, 400) if path.name in FEW and not is_full else picture
    truth = closed_truth(compiled, picture.o, picture.d, 2e-6, THIN)
    sure = ~truth.contested
    missed, false = (sure & truth.hit & ~picture.hit).sum(), (sure & ~truth.hit & picture.hit).sum()
    both = sure & truth.hit & picture.hit
    error = np.abs(picture.depth - truth.t)[both]
    slack = 16.0 * ULP * np.maximum(1.0, np.abs(truth.t[both]))
    outside = (picture.depth[both] < truth.early[both] - slack) | (picture.depth[both] > truth.late[both] + slack)
    spread = f"{np.median(error):.1e} / {np.quantile(error, 0.99):.1e} / {error.max():.1e}"
    print(f"{path.name}: {both.sum()} hits, {(~sure).sum()} contested, |dt| median / p99 / max {spread}")
    assert (missed, false, outside.sum()) == (0, 0, 0)
    at_the_eye, growth = footprint(compiled, (160, 90))
    assert np.median(error / (2.0 * (at_the_eye + growth * truth.t[both]))) <= EXACT


@pytest.mark.parametrize("path", SCENES + MODELS, ids=name)
def test_the_two_truths_agree(path: Path, tracing: Tracing) -> None:
    compiled = compiled_file(path)
    if not is_closed_form(compiled.scene.root):
        pytest.skip("not all parts have ray intervals in closed form")
    picture = every(tracing.picture(compiled, (80, 45)), 40)
    by_events = closed_truth(compiled, picture.o, picture.d, 2e-6, THIN)
    by_bisection = certified(compiled, picture, 1e-6)
    sure = ~by_events.contested & ~by_bisection.contested
    assert sure.mean() > 0.9
    np.testing.assert_array_equal(by_bisection.status[sure] == 1, by_events.hit[sure])
    both = sure & by_events.hit
    assert (by_events.t[both] > by_bisection.t_lo[both] - 1e-9).all()
    assert (by_events.t[both] < by_bisection.t_hi[both] + 1e-9).all()
