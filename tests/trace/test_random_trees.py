"""Law: whatever is built of whatever, the proven tracer and interval arithmetic agree on every uncontested ray."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, note, settings
from hypothesis import strategies as st
from scene_trees import KINDS, scenes, table
from truth import Tracing, certified, compiled_text, every, footprint, tolerance, verdict, wrong

from sdfc.api.request import View
from sdfc.diagnostics import SceneError
from sdfc.field.numeric import Evaluator
from sdfc.plan.steps import Many, leaves_of
from sdfc.shape.lower import lower

pytestmark = pytest.mark.gpu

FULL = os.environ.get("SDFC_FULL") == "1"
SIZE = (20, 20)
UP = (0.0, 1.0, 0.0)
VIEWS = [
    View(eye=(2.3, 1.9, 2.9), target=(0.0, 0.0, 0.0), up=UP, fov=0.6),
    View(eye=(-1.3, -2.9, 2.0), target=(0.1, 0.0, 0.0), up=UP, fov=0.6),
    View(eye=(0.0, 0.0, 4.0), target=(0.0, 0.0, 0.0), up=UP, height=2.2),
    View(eye=(0.1, 0.05, 0.0), target=(1.0, 0.3, 0.2), up=UP, fov=1.2),
]


def check(text: str, view: View, tracing: Tracing, most: int = 400) -> None:
    compiled = compiled_text(text)
    picture = tracing.picture(compiled, SIZE, view)
    for numbers in (picture.steps, picture.normal, picture.depth[picture.hit]):
        assert np.isfinite(numbers).all(), "a number is not finite"
    assert picture.steps.max() < 2048 + 3 * compiled.plan.events
    some, cone = every(picture, most), footprint(compiled, SIZE, view)
    near = tolerance(compiled, some, cone)
    truth = certified(compiled, some, near)
    result = verdict(compiled, some, truth, cone)
    bad = wrong(some, truth)[:3]
    places = [(some.o[:, i].tolist(), some.d[:, i].tolist(), some.depth[i], truth.t_lo[i]) for i in bad]
    assert (result.sure.missed, result.sure.false, result.sure.late) == (0, 0, 0), f"{result}\n{places}"
    assert result.sure.early == 0 and result.not_finite == 0, f"{result}"


@settings(
    max_examples=400 if FULL else 12,
    deadline=None,
    derandomize=not FULL,
    phases=(Phase.explicit, Phase.generate, *((Phase.shrink,) if FULL else ())),
    suppress_health_check=list(HealthCheck),
)
@given(text=scenes(), view=st.sampled_from(VIEWS))
def test_random_scenes(text: str, view: View, tracing: Tracing) -> None:
    note(text)
    check(text, view, tracing, 400 if FULL else 60)


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_alone_and_cut_by_each(kind: str, tracing: Tracing) -> None:
    """Every shape of the kind by itself, less a bore, and as what is cut away."""
    for shape in KINDS[kind]:
        parts = [f"({shape}).translate([-1, 0, 0])", f"(({shape}) - cylinder(radius: 0.2, height: 3).rotate(x: 70deg))"]
        parts.append(f"(box(size: [1.3, 1.1, 0.9]) - ({shape}).shear(xy: 0.3)).translate([1.2, 0, 0])")
        check("scene { " + " ".join(parts) + " }", VIEWS[0], tracing, 200 if FULL else 24)


@settings(
    max_examples=200 if FULL else 30, deadline=None, derandomize=not FULL, suppress_health_check=list(HealthCheck)
)
@given(text=scenes(), seed=st.integers(0, 2**31))
def test_the_passes_keep_the_sign(text: str, seed: int) -> None:
    """The normal form is the scene: the same sign at every point that is not at its surface."""
    try:
        compiled = compiled_text(text)
    except SceneError:
        return
    scene, frame = compiled.scene, compiled.frame
    p = np.random.default_rng(seed).uniform(-1.5, 1.5, (3, 300))
    own = (p - np.array(frame.centre)[:, None]) / frame.radius
    (as_written,) = Evaluator([lower(scene.root, scene.values.input("p"))])({"p": p}, {})
    (normal,) = Evaluator([lower(compiled.shape, scene.values.input("p"))])({"p": own}, {})
    clear = np.minimum(np.abs(as_written), np.abs(normal)) > 1e-9
    np.testing.assert_array_equal((as_written < 0)[clear], (normal < 0)[clear])


def test_many_and_cut(tracing: Tracing) -> None:
    """Tables beside other parts, and tables that are cut (and so are no members of the scene's union)."""
    compiled = compiled_text("scene { " + table(64, 1) + " }")
    assert isinstance(compiled.plan.root, Many) or any(isinstance(s, Many) for s in compiled.plan.root.steps)
    assert len(leaves_of(compiled.plan.root)) == 64
    for extra in ("", "torus(major: 0.6, minor: 0.1)", "box(size: [0.5, 0.5, 0.5]) - sphere(radius: 0.3)"):
        check("scene { " + table(64, 1) + " " + extra + " }", VIEWS[0], tracing, 20)
    check("scene { (" + table(60, 2) + ") - box(size: [1, 1, 1]) }", VIEWS[1], tracing, 20)
    check(
        "scene { " + table(60, 2).replace("sphere(radius: ", "box(size: [1, 1.4, 0.6] * ") + " }", VIEWS[1], tracing, 20
    )
