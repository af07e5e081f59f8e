"""Law: a scene that is one convex solid looks as it does with shadow rays, which are not even printed for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from truth import Tracing, compiled_text

from sdfc.api.renderer import Shot
from sdfc.api.request import View

pytestmark = pytest.mark.gpu

LIGHTS = """
light sun { direction: [-0.2, -0.8, -0.5], intensity: 3 }
light point { position: [2, 2, 2], intensity: 20 }
camera { eye: [2, 1.5, 3], target: [0, 0, 0], fov: 40deg }
"""
SOLIDS = {
    "closed": "ellipsoid(radii: [1, 0.6, 0.8]) & box(size: [1.6, 1, 2]).rotate(y: 30deg)",
    "marched": "smooth_intersection(sphere(radius: 1), box(size: [1.4, 1.4, 1.4]), blend: 0.2)",
    "endless": "plane(normal: [0, 1, 0])",
}


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
def test_no_shadows_on_a_convex_solid(solid: str, tracing: Tracing) -> None:
    compiled = compiled_text(f"scene {{ {solid} }}{LIGHTS}")
    assert compiled.plan.is_convex
    shadowed = replace(compiled, plan=replace(compiled.plan, is_convex=False), _texts={})
    assert "clearance(" in shadowed.glsl("radiance") and "clearance(" not in compiled.glsl("radiance")
    ours, theirs = (
        tracing.renderer.radiance(Shot(c, View(), {}, (160, 90)), 0, None).astype(float) for c in (compiled, shadowed)
    )
    assert (ours[..., 3] == theirs[..., 3]).all() and ours[..., 3].sum() > 1000
    # distances that are bounds only make the sky look less open than it is, and grazing light may touch the tolerance
    lit = np.abs(ours - theirs)[..., :3].max(axis=-1)
    assert np.median(lit) < 1e-3 and (lit > 0.05).mean() < 0.01


def test_what_is_not_convex_keeps_its_shadows() -> None:
    egg = "ellipsoid(radii: [1, 2, 3])"
    for solid in ("torus()", "sphere() - sphere(radius: 0.5)", "sphere() box()", f"{egg}.round(0.1)"):
        assert not compiled_text(f"scene {{ {solid} }}").plan.is_convex
