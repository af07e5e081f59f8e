"""Law: a scene without end has a straight horizon, and nothing above it; a floor that is blended keeps its scene's own
origin and unit."""

from __future__ import annotations

import numpy as np
import pytest
from truth import Tracing, compiled_text

from sdfc.api.cpu import CpuRenderer
from sdfc.api.renderer import Shot
from sdfc.api.request import View

pytestmark = pytest.mark.gpu

SIZE = (96, 54)
VIEW = View(eye=(2.0, 2.0, 5.0), target=(0.0, 0.9, 0.0), up=(0.0, 1.0, 0.0), fov=0.7)
FLOORS = {
    "cut": "difference(blend: 0.3) { plane(offset: -0.1) sphere(radius: 0.7) }",
    "chamfered": "difference(chamfer: 0.3) { plane(offset: -0.1) sphere(radius: 0.7) }",
    "joined": "union(blend: 0.4) { plane(offset: -0.1) sphere(radius: 0.6) }",
}


@pytest.mark.parametrize("floor", list(FLOORS))
def test_nothing_is_above_the_horizon(floor: str, tracing: Tracing) -> None:
    picture = tracing.picture(compiled_text(f"scene {{ {FLOORS[floor]} }}"), SIZE, VIEW)
    above = picture.d[1] > 1e-4  # radians
    assert above.sum() > 500
    assert not (picture.hit & above & (picture.depth > 50.0)).any()
    steep = picture.d[1] < -0.02
    assert picture.hit[steep].all()


@pytest.mark.parametrize("away", [0.0, 1e5])
@pytest.mark.parametrize("factor", [1.0, 1e-3, 1e3])
def test_a_blended_floor_keeps_the_scenes_origin_and_unit(away: float, factor: float, tracing: Tracing) -> None:
    body = (
        "union(blend: 0.4) { plane(offset: -0.1) sphere(radius: 0.6) box(size: [0.5, 0.5, 0.5]).translate([1, 0, 0]) }"
    )

    def seen(scale: float, move: float) -> np.ndarray:
        text = f"scene {{ {body}.scale({scale}).translate([{move}, {move}, {move}]) }}"
        eye, target = (tuple(scale * v + move for v in point) for point in (VIEW.eye, VIEW.target))
        view = View(eye=eye, target=target, up=VIEW.up, fov=VIEW.fov)
        first = tracing.renderer.probe(Shot(compiled_text(text), view, {}, SIZE), None)[0]
        return np.where(first[..., 3] > 0.5, first[..., 0] / scale, np.inf)

    plain, moved = seen(1.0, 0.0), seen(factor, away * factor)
    near = plain < 30.0
    assert ((moved < 30.0) != near).sum() <= 4
    both = near & (moved < 30.0)
    assert np.abs(plain[both] - moved[both]).max() < 2e-3


def test_both_renderers_agree_on_the_horizon(tracing: Tracing) -> None:
    shot = Shot(compiled_text(f"scene {{ {FLOORS['cut']} }}"), VIEW, {}, SIZE)
    hits = [renderer.probe(shot, None)[0][..., 3] > 0.5 for renderer in (tracing.renderer, CpuRenderer())]
    assert (hits[0] != hits[1]).sum() <= SIZE[0]  # one row: the horizon itself
