"""The CPU renderer: against analytic truth, against the scene's own symmetries, and against OpenGL."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sdfc.api.cpu import CpuRenderer
from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.diagnostics import Source
from sdfc.pipeline import Compiled, compile_scene, load
from sdfc.shade.present import present

Array = NDArray[np.floating]

SCENES = Path(__file__).parents[2] / "scenes"
SIZE = (48, 27)
CAMERA = "camera { eye: [0, 0, 5], target: [0, 0, 0], fov: 40deg }\n"


def compiled(text: str) -> Compiled:
    return compile_scene(load(Source("test.sdf", text)))


def shot(scene: Compiled, size: tuple[int, int] = SIZE) -> Shot:
    return Shot(scene, View(), {}, size)


def probe(text: str) -> list[Array]:
    return CpuRenderer().probe(shot(compiled(text)), None)


def sphere_depth(directions: Array, eye: Array, centre: Array, radius: float) -> tuple[Array, Array]:
    """Where unit directions enter and leave a ball; NaN for a miss."""
    away = centre - eye
    along = directions @ away
    with np.errstate(invalid="ignore"):
        half = np.sqrt(radius**2 - (away @ away - along**2))
    return along - half, along + half


def test_a_ball_is_where_it_is() -> None:
    first, normal, position, direction = probe(CAMERA + "scene { sphere(radius: 1).translate([0.3, -0.2, 0.5]) }")
    centre = np.array([0.3, -0.2, 0.5])
    depth, _ = sphere_depth(direction[..., :3], np.array([0.0, 0.0, 5.0]), centre, 1.0)
    hit = first[..., 3] > 0.0
    assert np.array_equal(hit, np.isfinite(depth))
    assert np.abs(first[hit, 0] - depth[hit]).max() < 1e-9
    assert np.all(first[~hit, 0] == -1.0)
    assert np.abs(position[hit, :3] - centre - normal[hit, :3]).max() < 1e-9


def test_a_ball_less_a_ball_shows_the_inner_wall_in_the_cutters_material() -> None:
    scene = "material a { color: #ff0000 }\nmaterial b { color: #00ff00 }\nscene { sphere(radius: 1).material(a) - " + (
        "sphere(radius: 0.8).translate([0, 0, 0.9]).material(b) }"
    )
    first, *_, direction = probe(CAMERA + scene)
    eye = np.array([0.0, 0.0, 5.0])
    enter, leave = sphere_depth(direction[..., :3], eye, np.zeros(3), 1.0)
    cut_enter, cut_leave = sphere_depth(direction[..., :3], eye, np.array([0.0, 0.0, 0.9]), 0.8)
    cut = (cut_enter <= enter) & (enter < cut_leave)
    truth = np.where(cut, np.where(cut_leave < leave, cut_leave, np.nan), enter)
    hit = first[..., 3] > 0.0
    assert np.array_equal(hit, np.isfinite(truth))
    assert (hit & cut).sum() > 50
    assert np.abs(first[hit, 0] - truth[hit]).max() < 1e-9
    assert np.array_equal(first[hit, 2], cut[hit].astype(float))


def test_a_flush_cut_leaves_no_film() -> None:
    """A block less a block that ends in the same face: nothing of the face is left, at any angle."""
    block = "(box(size: [1, 1, 1]) - box(size: [0.6, 0.6, 1])).rotate(x: 17deg).rotate(y: 31deg)"
    through = "(box(size: [1, 1, 1]) - box(size: [0.6, 0.6, 1.5])).rotate(x: 17deg).rotate(y: 31deg)"
    flush, clear = (probe(CAMERA + f"scene {{ {scene} }}")[0] for scene in (block, through))
    assert np.array_equal(flush[..., 3], clear[..., 3])
    hit = flush[..., 3] > 0.0
    assert 0 < hit.sum() < hit.size
    assert np.abs(flush[hit, 0] - clear[hit, 0]).max() < 1e-9


def test_marched_parts_agree_with_closed_forms() -> None:
    """A ball made by rounding a point of a box, which is marched, and the ball itself, which is not."""
    marched = probe(CAMERA + "scene { box(size: [0.002, 0.002, 0.002]).round(0.999) }")[0]
    closed = probe(CAMERA + "scene { sphere(radius: 1) }")[0]
    both = (marched[..., 3] > 0.0) & (closed[..., 3] > 0.0)
    assert (marched[..., 3] != closed[..., 3]).sum() <= 4
    assert np.abs(marched[both, 0] - closed[both, 0]).max() < 0.02


@pytest.mark.parametrize("scale", [0.01, 100.0])
def test_a_scene_larger_and_elsewhere_is_the_same_picture(scale: float) -> None:
    parts = "sphere(radius: 1) - box(size: [1, 1, 3]) | torus(major: 1.3, minor: 0.2)"
    here = probe(CAMERA + f"scene {{ union {{ {parts} }} }}")[0]
    away = 1e5 * scale
    camera = f"camera {{ eye: [{away}, 0, {5 * scale}], target: [{away}, 0, 0], fov: 40deg }}\n"
    there = probe(camera + f"scene {{ union {{ {parts} }}.scale({scale}).translate([{away}, 0, 0]) }}")[0]
    assert np.array_equal(here[..., 3], there[..., 3])
    hit = here[..., 3] > 0.0
    assert np.abs(there[hit, 0] / scale - here[hit, 0]).max() < 1e-4


def test_a_shadow_is_where_the_light_is_hidden() -> None:
    text = (
        "camera { eye: [0, 6, 0.01], target: [0, 0, 0], fov: 60deg }\n"
        "light sun { direction: [-1, -1, 0], color: #ffffff, intensity: 3 }\n"
        "scene { plane(normal: [0, 1, 0])\n sphere(radius: 0.5).translate([0, 1.5, 0]) }"
    )
    scene = compiled(text)
    light = CpuRenderer().radiance(shot(scene), 0, None)
    position = CpuRenderer().probe(shot(scene), None)[2]
    floor = np.abs(position[..., 1]) < 1e-6
    # the ball's shadow is an ellipse around [-1.5, 0, 0], 0.5 wide across the light and longer along it
    place = position - np.array([-1.5, 0.0, 0.0, 0.0])
    inside = (place[..., 0] / math.sqrt(2.0)) ** 2 + place[..., 2] ** 2
    dark, lit = light[floor & (inside < 0.2), :3], light[floor & (inside > 0.3), :3]
    assert len(dark) > 5
    assert dark.max() < 0.7 * lit.min()


def test_progress_rises_to_one_and_may_stop_the_work() -> None:
    scene = compiled(CAMERA + "scene { sphere(radius: 1) }")
    told: list[float] = []
    CpuRenderer().radiance(shot(scene, (400, 300)), 0, told.append)
    assert told == sorted(told) and told[-1] == 1.0 and len(told) > 1

    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        CpuRenderer().radiance(shot(scene, (400, 300)), 0, stop)


def test_samples_lie_in_different_places_of_the_pixel() -> None:
    scene = compiled(CAMERA + "scene { sphere(radius: 1) }")
    first, second = (CpuRenderer().radiance(shot(scene), sample, None) for sample in (0, 1))
    changed = np.any(first != second, axis=-1)
    assert 0 < (first[..., 3] != second[..., 3]).sum() < 60
    assert changed.mean() > 0.5


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["csg5", "die", "blobs", "bracket", "gyroid", "jewel", "lamp", "column"])
def test_the_same_picture_as_opengl(renderer: GlRenderer, name: str) -> None:
    path = SCENES / f"{name}.sdf"
    scene = compile_scene(load(Source(str(path), path.read_text()), path.parent))
    taken = shot(scene, (96, 54))
    first = renderer.probe(taken, None)[0], renderer.radiance(taken, 0, None)
    second = CpuRenderer().probe(taken, None)[0], CpuRenderer().radiance(taken, 0, None)
    hits = [probed[..., 3] > 0.0 for probed, _ in (first, second)]
    assert (hits[0] != hits[1]).sum() <= 2
    both = hits[0] & hits[1]
    difference = np.abs(first[0][..., 0] - second[0][..., 0])[both] / first[0][..., 0][both]
    assert np.median(difference) < 1e-6
    assert (difference > 1e-3).sum() <= 5
    colors = [present(light[..., :3]).astype(int) for _, light in (first, second)]
    off = np.abs(colors[0] - colors[1]).max(axis=-1)
    assert (off > 2).sum() <= 10
    assert off.mean() < 0.1


def test_a_blend_of_many_is_drawn() -> None:
    text = "scene { union(blend: 0.1) { for i in 0..200: sphere(radius: 0.1).translate([0.1 * i, 0, 0]) } }"
    assert (probe(text)[0][..., 3] > 0.5).any()
