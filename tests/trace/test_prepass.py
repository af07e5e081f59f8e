"""Law: the cone prepass loses nothing. No ray of a tile meets anything before the tile's start, whatever its sample."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from truth import Tracing, compiled_file, compiled_text

from sdfc.api.renderer import Shot, jitter
from sdfc.api.request import View
from sdfc.pipeline import Compiled, Options, compile_scene
from sdfc.plan.plan import TILE
from sdfc.tracers import TRACERS

pytestmark = pytest.mark.gpu

SCENES = Path(__file__).parent.parent.parent / "scenes"
SIZE = (150, 85)  # no multiple of a tile

RODS = "scene { for i in 0..9: torus(major: 0.4 + 0.05 * i, minor: 0.004).rotate(x: 23deg * i) }"
FLOOR = """scene {
    plane(normal: [0, 1, 0], offset: -1)
    union(blend: 0.3) { sphere(radius: 0.5) torus(major: 0.8, minor: 0.1) }.translate([0, 0.2, 0])
}
camera { eye: [2, 1, 3], target: [0, 0, 0] }
"""
ABOARD = "scene { torus(major: 0.8, minor: 0.2).twist(30deg) }\ncamera { eye: [0.8, 0, 0], target: [0, 0, 1] }"
TEXTS = {"rods": RODS, "floor": FLOOR, "aboard": ABOARD}
FILES = ("blobs.sdf", "column.sdf", "gyroid.sdf", "bracket.sdf", "jewel.sdf")
VIEWS = {
    "scene's own": View(),
    "parallel": View(eye=(3.0, 2.0, 4.0), target=(0.0, 0.0, 0.0), height=2.5),
    "far": View(eye=(300.0, 200.0, 400.0), target=(0.0, 0.0, 0.0), fov=0.008),
    "wide": View(eye=(1.2, 0.9, 1.3), target=(0.0, 0.0, 0.0), fov=2.6),
}


def scene(name: str, tracer: str = "proven") -> Compiled:
    return compiled_text(TEXTS[name], tracer) if name in TEXTS else compiled_file(SCENES / name, tracer)


def swept(compiled: Compiled) -> Compiled:
    return replace(compiled, plan=replace(compiled.plan, prepass=compiled.plan.can_sweep), _texts={})


@pytest.mark.parametrize("view", list(VIEWS))
@pytest.mark.parametrize("name", [*TEXTS, *FILES])
def test_no_ray_meets_anything_before_its_tile_starts(name: str, view: str, tracing: Tracing) -> None:
    plain = scene(name, "sphere")  # whose sweep holds the whole scene
    compiled = swept(plain)
    assert compiled.plan.prepass
    shot = Shot(compiled, VIEWS[view], {}, SIZE)
    with tracing.renderer.prepared(shot, "depth") as prepared:
        prepared.draw()
        assert prepared.sweep is not None
        tiles = prepared.sweep.tiles.read()[::-1, :, 0].astype(float)  # rows from the bottom, as tiles are counted
    starts = np.kron(tiles, np.ones((TILE, TILE)))[: SIZE[1], : SIZE[0]][::-1]
    for sample in range(3):
        uniforms = plain.uniforms(VIEWS[view], {}, SIZE, jitter(sample))
        with tracing.renderer.prepared(Shot(scene(name), VIEWS[view], {}, SIZE), "depth") as reference:
            reference.uniforms.update({k: v for k, v in uniforms.items() if k in reference.uniforms})
            reference.draw()
            first = reference.read().astype(float)
        hit = first[..., 3] > 0.5
        reach = first[..., 0] / plain.plan.radius
        early = reach[hit] - starts[hit]
        assert early.size == 0 or early.min() > -4e-6 * max(1.0, float(reach[hit].max())), f"{early.min():.1e}"


@pytest.mark.parametrize("tracer", [n for n, t in TRACERS.items() if t.guarantee.startswith("nothing missed")])
@pytest.mark.parametrize("name", ["rods", "floor", "aboard", "column.sdf"])
def test_pictures_are_the_same(name: str, tracer: str, tracing: Tracing) -> None:
    plain = scene(name, tracer)
    compiled = swept(plain)
    first, other = (tracing.renderer.probe(Shot(c, View(), {}, SIZE), None)[0] for c in (plain, compiled))
    finished = np.isin(first[..., 3], (0.0, 1.0)) & np.isin(other[..., 3], (0.0, 1.0))
    assert finished.mean() > 0.5
    hit, other_hit = (image[..., 3] > 0.5 for image in (first, other))
    differ = finished & (hit != other_hit)
    assert differ.sum() <= 2, f"{differ.sum()} of {finished.sum()} pixels"  # what is contested may go either way
    both = finished & hit & other_hit
    apart = np.abs(first[..., 0] - other[..., 0])[both] / np.maximum(first[..., 0][both], plain.plan.radius)
    assert np.quantile(apart, 0.99) < 2e-4


def test_a_scene_without_marching_is_not_swept(tracing: Tracing) -> None:
    compiled = compiled_text("scene { box(size: [1, 1, 1]) - sphere(radius: 0.6) }")
    assert not compile_scene(compiled.scene, Options(prepass=True)).plan.prepass
    assert not compiled.plan.can_sweep
