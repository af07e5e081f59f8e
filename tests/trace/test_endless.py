"""Law: what has no end is looked for only where it may be: no ray above a floor is marched to the horizon."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from truth import Tracing, compiled_text, footprint

from sdfc.api.request import View
from sdfc.field.numeric import Evaluator
from sdfc.measure.stress.record import Case
from sdfc.measure.stress.trial import tried
from sdfc.pipeline import Compiled
from sdfc.plan.steps import Any, Step, Within, leaves_of
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.trace import StepTracer
from sdfc.shape.lower import lower

pytestmark = pytest.mark.gpu

Array = NDArray[np.float64]

SIZE = (33, 19)  # odd: the row in the middle is level, the column in it along an axis
UP = (0.0, 1.0, 0.0)
WAVES = "waves(amplitude: 0.1, wavelength: 3)"
FLOORS = {
    "waves": WAVES,
    "turned waves": f"{WAVES}.rotate(x: 3deg, z: -10deg)",
    "squashed waves": f"{WAVES}.rotate(z: -8deg).scale([1.3, 0.5, 0.8])",
    "live waves": f"{WAVES}.rotate(z: turn)",
    "posts": "box(size: [0.3, 0.5, 0.3]).repeat(spacing: [1, 0, 1])",
    "heights": "heightfield(spacing: 1)",
    "blended": "union(blend: 0.4) { plane(offset: -0.1) sphere(radius: 0.6) }",
    "hollowed": "difference(blend: 0.3) { plane(offset: -0.1) sphere(radius: 0.7) }",
    "rough": "plane().displace(amplitude: 0.05, wavelength: 0.5)",
    "rough wall": "plane(normal: [-2, 0, 0], offset: 1).displace(amplitude: 0.05, wavelength: 0.5)",
}
EYE = (0.0, 1.0, 4.0)
MOST = 250  # steps of a ray, by the least steep
END = 100.0  # radii


def compiled(name: str) -> Compiled:
    return compiled_text(
        f"param turn = 5deg in -20deg..20deg\nscene {{ {FLOORS[name]} sphere(radius: 0.3).translate([0, 0.4, 0]) }}"
    )


def endless(step: Step) -> list[Within]:
    match step:
        case Any():
            return [found for s in step.steps for found in endless(s)]
        case Within() if not step.box.is_finite:
            return [step]
        case _:
            return []


@pytest.mark.parametrize("name", FLOORS)
def test_the_sides_that_there_are_hold_the_solid(name: str) -> None:
    made = compiled(name)
    (within,) = endless(made.plan.root)
    assert not within.is_needed
    random = np.random.default_rng(4)
    params = {"turn": (np.radians(5.0),)}
    p = np.concatenate([random.uniform(-3, 3, (3, 4000)), random.normal(size=(3, 4000)) * 1e3], axis=1)
    (leaf,) = leaves_of(within)
    part = leaf.part
    at = made.scene.values.input("p")
    root = lower(part.shape, at if part.inverse is None else part.inverse.apply(at))
    solid = np.broadcast_to(Evaluator([root])({"p": p}, params)[0], p.shape[1:]) <= 0.0
    assert solid.any()
    own = p if within.inverse is None else Evaluator([within.inverse.apply(at)])({"p": p}, params)[0]
    low, high = (np.array(end)[:, None] for end in (within.box.lo, within.box.hi))
    held = ((own >= low) & (own <= high)).all(axis=0)
    assert held[solid].all() and not held.all()


@pytest.mark.parametrize("name", FLOORS)
def test_no_ray_is_given_up_and_all_are_as_proved(name: str, tracing: Tracing) -> None:
    """Level rays, rays that go down a little and a lot, rays along an axis."""
    made = compiled(name)
    cases = [
        Case(name=f"{down}", text="", view=View(eye=EYE, target=(0.0, 1.0 - down, 0.0), up=UP, fov=0.3))
        for down in (0.0, 0.1, 1.0)
    ]
    for trial in tried(tracing, made, cases, SIZE):
        assert not trial.failures, f"down {trial.case.name}: {trial.failures}"
        steps = trial.picture.steps.max()
        assert steps <= MOST, f"{steps:g} steps, down {trial.case.name}"


@pytest.mark.parametrize("name", FLOORS)
def test_a_ray_along_the_floor_takes_few_steps(name: str, tracing: Tracing) -> None:
    """Ten times flatter is not ten times slower."""
    made = compiled(name)
    for rows in (10, 100):
        height = 2.0 / rows
        view = View(eye=(0.0, 1.0, 4.0), target=(0.0, 1.0 - height, 0.0), up=UP, fov=0.5 * height)
        picture = tracing.picture(made, SIZE, view)
        assert not picture.unfinished.any()
        assert picture.steps.max() <= MOST, f"{picture.steps.max():g} steps at {height:g} of four radii down"


@pytest.mark.parametrize("name", [n for n in FLOORS if n not in ("heights", "blended")])
def test_the_float64_twin_agrees(name: str, tracing: Tracing) -> None:
    made = compiled(name)
    view = View(eye=(0.0, 1.0, 4.0), target=(0.0, 0.6, 0.0), up=UP, fov=0.6)
    picture = tracing.picture(made, SIZE, view)
    formulas = Formulas(made.scene.values, {"turn": (np.radians(5.0),)}, made.plan.materials, made.setting.unpainted)
    count = picture.hit.size
    rays = Rays(picture.o, picture.d, np.zeros(count), footprint(made, SIZE, view))
    found, steps = StepTracer(made.plan, formulas).first(rays, np.zeros(count), np.full(count, END))
    assert steps.max() <= MOST
    near = picture.hit & (picture.depth < 0.9 * END)
    assert (near != (found < 0.9 * END)).mean() < 0.01
    both = near & (found < END)
    assert both.any() and np.quantile(np.abs(found - picture.depth)[both], 0.9) < 5e-3


@pytest.mark.parametrize("away", [1e2, 1e4])
@pytest.mark.parametrize("name", ["waves", "turned waves", "posts"])
def test_an_eye_far_from_the_scenes_middle_sees_what_is_under_it(name: str, away: float, tracing: Tracing) -> None:
    """The floor is there, however long the lengths that its place along the ray is reckoned from."""
    made = compiled(name)
    view = View(eye=(away, 0.3 * away, 0.0), target=(away, 0.0, 1.0), up=UP, fov=0.2)
    picture = tracing.picture(made, SIZE, view)
    assert not picture.unfinished.any()
    if name != "posts":
        assert picture.hit.all()
    assert picture.hit.mean() > 0.05
    assert np.isfinite(picture.depth[picture.hit]).all()
