"""Law: a ring is the same solid marched and by its dear closed form, and each is the truth's to its own precision."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from closed_truth import ClosedTruth, closed_truth, is_closed_form
from test_flush import PAIRS, Pair, assert_same, scene, views
from truth import THIN, Picture, Tracing, certified, every, footprint, tolerance, verdict, wrong

from sdfc import pipeline
from sdfc.api.cpu import CpuRenderer
from sdfc.api.program import compile as compile_program
from sdfc.api.renderer import Shot
from sdfc.api.request import View
from sdfc.diagnostics import Source
from sdfc.pipeline import Compiled, Options
from sdfc.plan.prove import Rays
from sdfc.plan.steps import is_closed

pytestmark = pytest.mark.gpu

ULP = 2.0**-23
RING = "torus(major: 0.7, minor: 0.3)"
RINGS = {
    "one": RING,
    "thin": "torus(major: 1, minor: 0.01).rotate(x: 50deg)",
    "no hole to speak of": "torus(major: 0.5, minor: 0.4999).rotate(x: 80deg)",
    "cut in half": f"{RING} & box(size: [3, 1, 3]).translate([0, 0.5, 0])",
    "cut by a ring": f"{RING} - torus(major: 0.7, minor: 0.2).rotate(x: 90deg).translate([0.7, 0, 0])",
    "cut away": f"box(size: [1.8, 0.8, 1.8]) - {RING}.translate([0, 0.4, 0])",
    "elliptical": f"{RING}.scale([1, 1.5, 0.8]).rotate(x: 70deg)",
    "sheared": f"{RING}.shear(xy: 0.4).rotate(z: 20deg)",
    "linked": f"{RING.replace('0.3', '0.15')} {RING.replace('0.3', '0.15')}.rotate(x: 90deg).translate([0.7, 0, 0])",
    "revolved": "circle(radius: 0.2).translate([0.7, 0]).revolve()",
}
UP = (0.0, 1.0, 0.0)
VIEWS = {
    "from above": View(eye=(2.3, 1.9, 2.9), target=(0.0, 0.0, 0.0), up=UP, fov=0.6),
    "along the plane": View(eye=(0.0, 0.3, 4.0), target=(0.0, 0.3, 0.0), up=UP, height=2.2),
    "through the hole": View(eye=(0.1, 0.05, 0.0), target=(1.0, 0.1, 0.2), up=UP, fov=1.2),
    "along the axis": View(eye=(0.0, 4.0, 0.0), target=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), height=2.6),
}


def compiled(text: str, rays: Rays) -> Compiled:
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text)), Options(rays=rays))


def assert_true_to_ulps(picture: Picture, truth: ClosedTruth, what: str) -> None:
    """No hit missed, none invented, and each within what an error of a few roundings makes of the solid."""
    sure = ~truth.contested
    assert (sure & truth.hit).any(), f"{what}: nothing is certain"
    missed, false = (sure & truth.hit & ~picture.hit).sum(), (sure & ~truth.hit & picture.hit).sum()
    both = sure & truth.hit & picture.hit
    slack = 16.0 * ULP * np.maximum(1.0, np.abs(truth.t[both]))
    early = (picture.depth[both] < truth.early[both] - slack).sum()
    late = (picture.depth[both] > truth.late[both] + slack).sum()
    assert (missed, false, early, late) == (0, 0, 0, 0), what


@pytest.mark.parametrize("name", RINGS)
def test_both_ways_against_interval_arithmetic(name: str, tracing: Tracing, is_full: bool) -> None:
    size, most = ((160, 90), 4000) if is_full else ((48, 32), 150)
    for rays in ("all", "cheap"):
        made = compiled(f"scene {{ {RINGS[name]} }}", rays)
        assert is_closed(made.plan.root) == (rays == "all")
        for where, view in VIEWS.items():
            picture = every(tracing.picture(made, size, view), most)
            cone = footprint(made, size, view)
            truth = certified(made, picture, tolerance(made, picture, cone))
            result = verdict(made, picture, truth, cone)
            bad = wrong(picture, truth)[:3]
            assert result.correct, f"{rays}, {where}: {result}\no {picture.o[:, bad].T}, d {picture.d[:, bad].T}"


@pytest.mark.parametrize("name", [name for name in RINGS if name != "revolved"])  # this truth reads what is written
def test_the_closed_form_to_a_few_ulps(name: str, tracing: Tracing) -> None:
    made = compiled(f"scene {{ {RINGS[name]} }}", "all")
    assert is_closed_form(made.scene.root) and is_closed(made.plan.root)
    for where, view in VIEWS.items():
        picture = tracing.picture(made, (96, 64), view)
        assert_true_to_ulps(picture, closed_truth(made, picture.o, picture.d, 2e-6, THIN), where)


@pytest.mark.parametrize("pair", [p for p in PAIRS if "torus" in p.flush], ids=lambda p: p.name)
def test_coincident_faces_of_rings(pair: Pair, tracing: Tracing) -> None:
    """As test_flush: no film, no crack, no wrong normal, from all sides."""
    flush, plain = (compiled(scene(solid), "all") for solid in (pair.flush, pair.plain))
    assert is_closed(flush.plan.root)
    failures = []
    for turn, tilt in [(0.0, 0.0), (90.0, 0.0), (37.0, 0.0), (45.0, 45.0), (0.3, 0.0), (179.0, 61.0)]:
        params: dict[str, tuple[float, ...]] = {"turn": (math.radians(turn),), "tilt": (math.radians(tilt),)}
        for name, view in views().items():
            one, other = (tracing.picture(c, (49, 49), view, params) for c in (flush, plain))
            try:
                assert_same(one, other, pair.skin)
            except AssertionError as error:
                failures.append(f"turn {turn}, tilt {tilt}, {name}: {' '.join(str(error).split())[:110]}")
    assert not failures, "\n".join(failures)


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.9, 0.9999])
@pytest.mark.parametrize("size", [1e-1, 1e-2, 1e-3, 1e-4])
def test_a_ring_that_is_small_in_its_scene(size: float, ratio: float, tracing: Tracing) -> None:
    """The ray starts near the scene's origin, up to 1 / size of the ring's sizes away from the ring.

    What is judged is the tracer's own answer, as depth images show it: the Newton step of `probe` looks at the surface
    from a few tolerances back, and that is not little where the radius of a curve is not many of them.
    """
    major, at = size / (1.0 + ratio), (0.53, -0.31, 0.44)
    ring = f"torus(major: {major}, minor: {major * ratio}).rotate(x: 33deg).rotate(z: 71deg).translate({list(at)})"
    posts = "sphere(radius: 0.05).translate([-0.95, 0, 0]) sphere(radius: 0.05).translate([0.95, 0, 0])"
    made = compiled(f"scene {{ {ring} {posts} }}", "all")
    for eye in [(0.5, 0.6, 2.0), (2.0, -0.3, 0.45), (-0.4, -2.2, -0.7)]:
        view = View(eye=eye, target=at, up=(0.1, 1.0, 0.2), height=2.4 * size)
        picture = tracing.picture(made, (48, 48), view)
        depth = tracing.renderer.depth(Shot(made, view, {}, (48, 48)), None)[..., 0].ravel() / made.plan.radius
        picture = replace(picture, depth=np.where(picture.hit, depth, np.nan).astype(float))
        truth = closed_truth(made, picture.o, picture.d, 2e-6, THIN)
        assert_true_to_ulps(picture, truth, f"from {eye}")


def test_the_explanation_says_why_a_closed_form_is_left_out() -> None:
    text = f"scene {{ {RING} sphere(radius: 0.2) }}"
    told = {rays: compiled(text, rays).explanation() for rays in ("cheap", "all")}
    assert told["cheap"].count("a closed form is known, dearer here than marching") == 1
    assert "torus_1 (test.sdf:1:9): closed form, 2 interval(s) a ray" in told["all"]
    assert "dearer" not in told["all"]


def test_what_draws_chooses_the_closed_forms(tracing: Tracing) -> None:
    """The CPU takes the dear ones too, OpenGL only where it is no CPU; both show the same ring."""
    program = compile_program(f"scene {{ {RING}.rotate(x: 50deg) - sphere(radius: 0.4).translate([0.6, 0, 0.3]) }}")
    assert CpuRenderer().rays == "all"
    assert tracing.renderer.rays == ("cheap" if tracing.renderer.device.is_llvmpipe else "all")
    with program:
        images = [program.render((80, 50), backend=backend, aovs=["depth"]).aovs["depth"] for backend in ("cpu", "gl")]
    hits = [np.isfinite(depth) for depth in images]
    assert (hits[0] != hits[1]).sum() <= 2 and hits[0].sum() > 400  # at the edge
    both = hits[0] & hits[1]
    assert np.quantile(np.abs(images[0][both] - images[1][both]), 0.98) < 1e-4
