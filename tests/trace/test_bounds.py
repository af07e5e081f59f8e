"""Law: the tracer's work is bounded, no number is not finite, and no place of the eye breaks it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from closed_truth import closed_truth
from truth import THIN, Picture, Tracing, compiled_text, every

from sdfc.api.renderer import Shot
from sdfc.api.request import View
from sdfc.pipeline import Compiled

LLVMPIPE_TURNS = 65_535  # all loops of an invocation together (GL.md 0): then they stop, silently
CSG5 = (
    "(box(size: [1.6, 1.6, 1.6]) & sphere(radius: 1.05)) - (cylinder(radius: 0.5, height: 3)"
    " | cylinder(radius: 0.5, height: 3).rotate(x: 90deg) | cylinder(radius: 0.5, height: 3).rotate(z: 90deg))"
)
UP = (0.0, 1.0, 0.0)
ROOT3 = 3.0**-0.5


def spheres(count: int, cut: str = "") -> str:
    """A cloud of like balls, each perhaps cut."""
    return (
        f"union(for i in 0..{count}: (sphere(radius: 0.02){cut}).translate("
        "[2 * fract(0.7548776 * i) - 1, 2 * fract(0.5698402 * i) - 1, 2 * fract(0.3247179 * i) - 1]))"
    )


def suns(count: int) -> str:
    return "".join(f"light sun {{ direction: [{i}, -2, 1], intensity: 1 }}\n" for i in range(count))


LARGE = {
    "300 balls": f"scene {{ {spheres(300)} }}",
    "4000 balls": f"scene {{ {spheres(4000)} }}",
    "4800 balls, 9 suns": f"{suns(9)}scene {{ {spheres(4800)} }}",
    "12 cut balls": f"scene {{ {spheres(12, ' - box(size: [0.02, 0.02, 0.1])').replace('0.02', '0.2')} }}",
    "8 blends, 4 suns": suns(4)
    + "scene { union(for i in 0..8: union(blend: 0.1) { sphere(radius: 0.2) box(size: [0.5, 0.1, 0.1]) }"
    ".translate([i, 0, 0])) }",
    "a torus among 300 balls, 3 suns": f"{suns(3)}scene {{ torus(major: 1, minor: 0.3) {spheres(300)} }}",
}


def most_turns(compiled: Compiled) -> int:
    """The loop turns of a pixel of the picture, at worst: its rays with all their steps, and the ambient light."""
    text = compiled.glsl("picture")
    found = re.search(r"const int MOST_STEPS = (\d+);", text)
    march = int(found.group(1)) if found and "float march(" in text else 0
    plan, rays = compiled.plan, 1 + len(compiled.setting.lights)
    a_ray = plan.table_turns + plan.events + march
    return rays * (1 + a_ray) + 4 * (1 + plan.table_turns)


@pytest.mark.parametrize("name", LARGE)
def test_loops_end_before_llvmpipe_ends_them(name: str) -> None:
    assert most_turns(compiled_text(LARGE[name])) < LLVMPIPE_TURNS


def judged(picture: Picture, compiled: Compiled, slack: float = 4e-6) -> None:
    """Against the merged intervals: nothing missed, nothing invented, every depth right."""
    for numbers in (picture.steps, picture.normal, picture.depth[picture.hit]):
        assert np.isfinite(numbers).all()
    truth = closed_truth(compiled, picture.o, picture.d, 2e-6, THIN)
    sure = ~truth.contested
    assert sure.mean() > 0.95
    assert (sure & (truth.hit != picture.hit)).sum() == 0
    both = sure & truth.hit
    early, late = truth.early[both] - picture.depth[both], picture.depth[both] - truth.late[both]
    assert max(early.max(initial=-1.0), late.max(initial=-1.0)) < slack
    length = np.linalg.norm(picture.normal[:, picture.hit], axis=0)
    assert np.abs(length - 1.0).max(initial=0.0) < 1e-5


@pytest.mark.gpu
@pytest.mark.parametrize(
    "view",
    [
        View(eye=(3.0, 2.4, 3.6), target=(0.0, 0.0, 0.0), up=UP, height=2.6),
        View(eye=(0.0, 0.0, 3.0), target=(0.0, 0.0, 0.0), up=UP, height=2.6),
        View(eye=(0.0, 0.0, 0.0), target=(1.0, 0.9, 0.7), up=UP, fov=1.9),
        View(eye=(0.0, 0.7, 0.0), target=(0.1, 0.0, 0.2), up=UP, fov=1.5),
        View(eye=(0.8 + 1e-4, 0.55, 0.2), target=(0.0, 0.55, 0.1), up=UP, fov=1.0),
        View(eye=(0.8 + 1e-5, 0.55, 0.2), target=(0.8, 1.5, 0.2), up=(1.0, 0.0, 0.0), fov=1.0),
    ],
    ids=["parallel", "along an axis", "from within a void", "in a bore", "near a face", "along a face"],
)
def test_every_place_of_the_eye(view: View, tracing: Tracing) -> None:
    compiled = compiled_text(f"scene {{ {CSG5} }}")
    judged(tracing.picture(compiled, (96, 54), view), compiled)


@pytest.mark.gpu
def test_an_eye_in_the_solid_sees_it_at_once(tracing: Tracing) -> None:
    for solid in (CSG5, "torus(major: 0.9, minor: 0.4).rotate(z: 30deg)", "box(size: [2, 2, 2]).round(0.1)"):
        compiled = compiled_text(f"scene {{ {solid} | sphere(radius: 0.2).translate([0.6, 0.6, 0.6]) }}")
        view = View(eye=(0.62, 0.58, 0.6), target=(0.0, 0.0, 0.0), up=UP, fov=1.5)
        picture = tracing.picture(compiled, (32, 18), view)
        assert picture.hit.all()
        assert (picture.depth >= 0.0).all(), "seen behind the eye"
        assert picture.depth.max() < 2e-5


@pytest.mark.gpu
@pytest.mark.parametrize("radii", [1e2, 1e4])
def test_from_far_away(radii: float, tracing: Tracing) -> None:
    """The depth has the float32 roundings of its own size; hits and normals have none of them."""
    compiled = compiled_text(f"scene {{ {CSG5} }}")
    far = radii * ROOT3
    view = View(eye=(far, 0.8 * far, 1.2 * far), target=(0.0, 0.0, 0.0), up=UP, fov=2.6 / radii)
    picture = tracing.picture(compiled, (96, 54), view)
    judged(picture, compiled, slack=2.0 * float(np.spacing(np.float32(2.0 * radii))))
    faces = np.sort(np.abs(picture.normal[:, picture.hit]), axis=0)
    assert (faces[2] > 0.9999).mean() > 0.1, "no flat face is seen"


@pytest.mark.gpu
def test_many_balls_are_all_there(tracing: Tracing) -> None:
    compiled = compiled_text(f"scene {{ {spheres(600)} }}")
    judged(every(tracing.picture(compiled, (48, 27)), 100), compiled)


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["300 balls", "12 cut balls"])
def test_every_number_of_a_picture_is_finite(name: str, tracing: Tracing) -> None:
    compiled = compiled_text(LARGE[name])
    shot = Shot(compiled, View(), {}, (48, 27))
    images = [tracing.renderer.radiance(shot, 0, None), *tracing.renderer.probe(shot, None)]
    for image in images:
        assert np.isfinite(image).all()
    assert images[1][..., 1].max() <= 2048 + plan_events(compiled)
    assert images[0][..., 3].any()


def plan_events(compiled: Compiled) -> int:
    """Steps between events count too."""
    return compiled.plan.events + 1
