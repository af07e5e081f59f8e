"""Law: an eye far away sees what is thin as one close by does: rays are moved to the scene before they are traced."""

from __future__ import annotations

import numpy as np
import pytest
from truth import Tracing, compiled_text

from sdfc.api import renderer
from sdfc.api.request import View
from sdfc.measure.stress.record import Case
from sdfc.measure.stress.trial import tried
from sdfc.plan.plan import NEAR_EYE

pytestmark = pytest.mark.gpu

SIZE = (41, 31)
PLATES = {
    "marched": "rounded_box(size: [1, 1, 0.004], radius: 0.002) - cylinder(radius: 0.2, height: 1).rotate(x: 90deg)",
    "solved": "box(size: [1, 1, 0.004]) - cylinder(radius: 0.2, height: 1).rotate(x: 90deg)",
    "thinner": "rounded_box(size: [1, 1, 0.0004], radius: 0.0002) & sphere(radius: 0.6)",
}
FAR = (2.0, 30.0, 1e3, 1e5, 1e6)  # of the eye; the radius is less than one
WAYS = [(distance, 2) for distance in FAR] + [(distance, 1) for distance in FAR if distance < 0.5 * NEAR_EYE]


def case(distance: float, is_parallel: bool) -> Case:
    eye = (0.55 * distance, 0.45 * distance, 0.7 * distance)
    up, target = (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
    wide = View(eye=eye, target=target, up=up, height=1.6)
    return Case(
        name=f"{distance:g}",
        text="",
        view=wide if is_parallel else View(eye=eye, target=target, up=up, fov=min(0.8, 1.6 / distance)),
    )


@pytest.mark.parametrize(("distance", "steps"), WAYS)
@pytest.mark.parametrize("name", PLATES)
def test_a_plate(name: str, distance: float, steps: int, tracing: Tracing, monkeypatch: pytest.MonkeyPatch) -> None:
    """By both forms of the way to the scene: that in two steps is for every eye, that in one for near ones."""
    monkeypatch.setattr(renderer, "is_near", lambda uniforms: steps == 1)
    compiled = compiled_text(f"scene {{ {PLATES[name]} }}")
    trials = tried(tracing, compiled, [case(distance, p) for p in (False, True)], SIZE)
    for trial in trials:
        assert not trial.failures, f"from {trial.case.name}: {trial.failures}"
        through = ~trial.picture.hit & trial.sure
        assert trial.picture.hit.sum() > 200 and through.sum() > 20, "the plate and its hole"
    if distance > 1e4:
        assert np.abs(trials[0].picture.o).max() > 0.4 * distance / compiled.frame.radius
