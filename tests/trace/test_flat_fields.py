"""Law: however little a field says of distances, hits of it, beside it and where it is cut are where it is proved."""

from __future__ import annotations

import pytest
from truth import Tracing, compiled_text

from sdfc.measure.stress.record import Case
from sdfc.measure.stress.trees import VIEWS
from sdfc.measure.stress.trial import tried
from sdfc.plan.plan import SMALLEST_TOLERANCE
from sdfc.plan.steps import Ball, leaves_of

SIZE = (48, 27)
NEAR = 64.0 * SMALLEST_TOLERANCE  # in the scene's radius, and far less than what a field so flat may be mistaken by

# a thousandth of a distance, in a form that no factor can be taken from
FLAT = "field flat() = 0.001 * length(p * [1, 1.5, 2]) - 0.0006 bounds -[0.61, 0.41, 0.31] .. [0.61, 0.41, 0.31]\n"
MELTED = "union(blend: {width}) {{ flat() sphere(radius: 0.3).translate([0.3, 0.4, 0.2]) }}"
BESIDE = "rounded_cylinder(radius: 0.45, height: 0.9, rounding: 0.1).translate([0.8, 0.4, 0])"
WITH_PARABOLAS = {
    "less a ball": "flat() - sphere(radius: 0.4).translate([0.3, 0.2, 0.3])",
    "in a box": "flat() & box(size: [0.9, 0.9, 0.5])",
    "less a bore, beside a box": "(flat().translate([0.1, 0, 0]) - box(size: [0.3, 0.3, 3]))"
    " rounded_box(size: [0.4, 0.4, 0.4], radius: 0.1).translate([0.6, 0.5, 0])",
    "through others": f"flat() rounded_box(size: [0.9, 0.7, 0.3], radius: 0.12) {BESIDE}",
}
BY_PIECES = {
    "blended, through another": f"{MELTED.format(width=0.1)} {BESIDE}",
    "blended, less two": f"{MELTED.format(width=0.02)} - ellipsoid(radii: [0.7, 0.4, 0.3]).translate([0.6, 0.4, 0.3])"
    " - box_frame(size: [1, 1, 1], edge: 0.12)",
}


@pytest.mark.gpu
@pytest.mark.parametrize("name", [*WITH_PARABOLAS, *BY_PIECES])
def test_hits_are_where_they_are_proved(name: str, tracing: Tracing) -> None:
    text = FLAT + "scene { " + (WITH_PARABOLAS | BY_PIECES)[name] + " }"
    compiled = compiled_text(text)
    flat = [leaf for leaf in leaves_of(compiled.plan.root) if isinstance(leaf, Ball) and leaf.is_no_distance]
    assert [bool(leaf.ahead) for leaf in flat] == [name in BY_PIECES], compiled.explanation()
    cases = [Case(name=f"{name} {i}", text=text, view=view) for i, view in enumerate(VIEWS)]
    for trial in tried(tracing, compiled, cases, SIZE):
        assert not trial.failures, trial.case.name
        assert trial.error.size > 30 and trial.error.max() < NEAR, trial.case.name
