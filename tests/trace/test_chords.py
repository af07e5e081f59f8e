"""Law: whoever looks out of a convex hollow, along its wall or not, sees the wall after few steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from truth import Tracing, certified, compiled_text, footprint, tolerance, verdict, wrong

from sdfc.api.request import View
from sdfc.plan.steps import Chord, leaves_of
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.trace import StepTracer
from sdfc.shape.lower import FAR

pytestmark = pytest.mark.gpu

SIZE = (33, 25)
HOLLOWS = {
    "room": "rounded_box(size: [1.8, 1.8, 1.8], radius: 0.3)",
    "low room": "rounded_box(size: [1.8, 0.3, 1.8], radius: 0.1)",
    "drum": "rounded_cylinder(radius: 0.9, height: 1.2, rounding: 0.05)",
    "egg": "rounded_box(size: [1.4, 1.6, 1.6], radius: 0.6).scale([1.1, 0.5, 0.9])",
    "turned room": "rounded_box(size: [1.2, 1.2, 1.2], radius: 0.2).rotate(x: 30deg, z: 20deg)",
}
WALLS = {"room": (0.9, 0.0, 0.0), "low room": (0.1, 0.15, -0.2), "drum": (0.9, 0.1, 0.0), "egg": (0.0, 0.4, 0.0)}
CENTRES = dict.fromkeys(HOLLOWS, (0.05, -0.02, 0.03))
MOST = 64  # steps: a bisection to the last digit takes 24


def view(eye: tuple[float, float, float], way: tuple[float, float, float]) -> View:
    return View(eye=eye, target=(eye[0] + way[0], eye[1] + way[1], eye[2] + way[2]), up=(0.3, 1.0, 0.2), fov=1.2)


@pytest.mark.parametrize("way", [(1.0, 0.02, 0.0), (-0.3, 0.8, 0.5), (0.0, 1e-4, 1.0)])
@pytest.mark.parametrize("place", [WALLS, CENTRES], ids=["on the wall", "in the middle"])
@pytest.mark.parametrize("name", HOLLOWS)
def test_a_hollow(
    name: str,
    place: dict[str, tuple[float, float, float]],
    way: tuple[float, float, float],
    tracing: Tracing,
) -> None:
    if name not in place:
        place = CENTRES
    compiled = compiled_text(f"scene {{ box(size: [2, 2, 2]) - {HOLLOWS[name]} }}")
    assert any(isinstance(leaf, Chord) for leaf in leaves_of(compiled.plan.root)), "this is not stepped by chords"
    seen = view(place[name], way)
    picture = tracing.picture(compiled, SIZE, seen)
    assert not picture.unfinished.any() and picture.steps.max() <= MOST, f"{picture.steps.max():g} steps"
    cone = footprint(compiled, SIZE, seen)
    truth = certified(compiled, picture, tolerance(compiled, picture, cone))
    result = verdict(compiled, picture, truth, cone)
    assert result.correct and not wrong(picture, truth).size, str(result)
    formulas = Formulas(compiled.scene.values, {}, compiled.plan.materials, compiled.setting.unpainted)
    rays = Rays(picture.o, picture.d, np.zeros(picture.hit.size), cone)
    start, end = np.zeros(picture.hit.size), np.full(picture.hit.size, FAR)
    found, steps = StepTracer(compiled.plan, formulas).first(rays, start, end)
    assert steps.max() <= MOST, f"the float64 twin takes {steps.max():g}"
    twin = replace(picture, hit=found < FAR, depth=np.where(found < FAR, found, np.nan))
    assert verdict(compiled, twin, truth, cone).correct
