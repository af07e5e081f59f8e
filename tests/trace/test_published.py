"""Laws over the whole table of tracers: what each says in `guarantee` holds, and what its paper promises is there."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from truth import Picture, Tracing, certified, compiled_file, compiled_text, every, footprint, tolerance, verdict, wrong

from sdfc.api.renderer import Shot
from sdfc.api.request import View
from sdfc.field.numeric import Evaluator
from sdfc.pipeline import Compiled, Options, compile_scene
from sdfc.plan.plan import FINE, LIFT
from sdfc.reference.certify import Certificate
from sdfc.scene.model import Scene
from sdfc.shape.lower import lower
from sdfc.tracers import TRACERS, choice

pytestmark = pytest.mark.gpu

SCENES = Path(__file__).parent.parent.parent / "scenes"
SIZE = (80, 45)
PUBLISHED = ("relaxed", "enhanced", "auto_relaxed", "segment", "liktor")
VARIANTS = (
    "relaxed:omega=1.6",
    "relaxed:omega=1.99",
    "relaxed:reduce=1",
    "relaxed:reduce=2",
    "enhanced:omega=1",
    "auto_relaxed:beta=1",
    "segment:symmetric=1",
    "segment:growth=4",
    "liktor:min_step=4:refinements=8",
    "liktor:plain=1",
)
RODS = "scene { for i in 0..13: capsule(from: [-1, 0.13 * i - 0.8, 0], to: [1, 0.8 - 0.13 * i, 0.4], radius: 0.006) }"
FLOOR = """scene { plane(normal: [0, 1, 0]) box(size: [1, 0.6, 0.4]).translate([0, 0.3, 0]) - sphere(radius: 0.3) }
camera { eye: [2, 0.4, 3], target: [0, 0.3, 0], fov: 50deg }
"""
FAR_AWAY = """scene { union { box(size: [1, 1, 1]).round(0.1) sphere(radius: 0.4).translate([0, 0.8, 0]) }.scale(0.01)
    .translate([1000, 2000, -3000]) }
"""
RAYS = {  # how many are proved: interval arithmetic over hundreds of parts takes its time
    "jewel.sdf": 200,
    "city.sdf": 6,
    "blobs.sdf": 120,
    "column.sdf": 120,
    "csg5.sdf": 400,
    "rods": 200,
    "floor": 300,
    "far": 300,
}
TEXTS = {"rods": RODS, "floor": FLOOR, "far": FAR_AWAY}


@cache
def plain(name: str) -> Scene:
    return (compiled_text(TEXTS[name]) if name in TEXTS else compiled_file(SCENES / name)).scene


def scene(name: str, spec: str, most_steps: int | None = None) -> Compiled:
    return compile_scene(plain(name), Options(spec, most_steps=most_steps))


@dataclass(frozen=True, slots=True)
class Known:
    """What is proved of a scene's rays, where a tracer errs by no more than `near`."""

    rays: Picture
    truth: Certificate
    near: float


KEPT: dict[tuple[str, float], Known] = {}


def known(name: str, tracing: Tracing, least_step: float = 0.0) -> Known:
    """`least_step`: in half pixels, what a tracer may pass over; it loses what is nowhere deeper than half of that."""
    if (name, least_step) not in KEPT:
        compiled = scene(name, "sphere")
        rays = every(tracing.picture(compiled, SIZE), RAYS[name])
        near = tolerance(compiled, rays, footprint(compiled, SIZE)) * max(1.0, 0.25 * least_step / FINE)
        KEPT[name, least_step] = Known(rays, certified(compiled, rays, near), near)
    return KEPT[name, least_step]


def told(name: str, spec: str, tracing: Tracing) -> tuple[Compiled, Picture]:
    compiled = scene(name, spec)
    return compiled, every(tracing.picture(compiled, SIZE), RAYS[name])


def least_step(spec: str) -> float:
    return choice(spec).values.get("min_step", 0.0)


CASES = [(n, s) for n in RAYS for s in TRACERS] + [(n, s) for n in ("csg5.sdf", "rods", "floor") for s in VARIANTS]


@pytest.mark.parametrize(("name", "spec"), CASES)
def test_what_is_guaranteed(name: str, spec: str, tracing: Tracing) -> None:
    """Nothing missed, invented or late, and every hit within tolerance, but for contested rays and those given up."""
    proved = known(name, tracing, least_step(spec))
    compiled, picture = told(name, spec, tracing)
    np.testing.assert_array_equal(picture.d, proved.rays.d)
    assert picture.unfinished.mean() <= 0.03, "a few rays along the horizon"
    finished = np.flatnonzero(~picture.unfinished)
    answers = picture.some(finished)
    truth = Certificate(*(getattr(proved.truth, field)[finished] for field in Certificate.__slots__))
    result = verdict(compiled, answers, truth, footprint(compiled, SIZE))
    print(f"{name} {spec}: {result}")
    bad = wrong(answers, truth)
    assert bad.size == 0, f"{result}\nfirst wrong rays: o {answers.o[:, bad[:3]].T}, d {answers.d[:, bad[:3]].T}"
    assert (result.sure.late, result.not_finite) == (0, 0), f"{result}"
    cone = footprint(compiled, SIZE)
    enough = np.maximum(0.5 * proved.near, FINE * (cone[0] + cone[1] * answers.depth)) + 4e-6 * (1.0 + answers.depth)
    value = residuals(compiled, answers.o + answers.depth * answers.d)
    off = np.flatnonzero(answers.hit & ~truth.contested & ~(np.abs(value) <= enough))
    assert off.size == 0, f"{value[off[:5]]} where {enough[off[:5]]} is enough"
    assert result.sure.rays > 0.6 * finished.size, "the truth excuses too much"


def mean_evaluations(name: str, spec: str, tracing: Tracing) -> float:
    with tracing.renderer.prepared(Shot(scene(name, spec), View(), {}, (160, 90)), "depth") as prepared:
        prepared.draw()
        return float(prepared.read()[..., 2].mean())


@pytest.mark.parametrize("name", ["jewel.sdf", "city.sdf", "blobs.sdf", "csg5.sdf"])
def test_fewer_evaluations(name: str, tracing: Tracing) -> None:
    """As the papers find: each looks at the scene less often than the one before; the counts are exact."""
    counts = {s: mean_evaluations(name, s, tracing) for s in ("sphere", "relaxed", "enhanced", "auto_relaxed")}
    print(name, counts)
    assert counts["relaxed"] < 1.01 * counts["sphere"]
    assert counts["enhanced"] < 0.95 * counts["relaxed"]
    assert counts["auto_relaxed"] < 0.95 * counts["relaxed"]


def test_segments_grow_where_the_ray_recedes(tracing: Tracing) -> None:
    """Along a floor balls shrink and slopes do not: the slope of the field decides (and one side of it is enough)."""
    balls, symmetric, one_sided = (
        mean_evaluations("jewel.sdf", s, tracing) for s in ("auto_relaxed", "segment:symmetric=1", "segment")
    )
    assert one_sided < symmetric < 0.6 * balls


@pytest.mark.parametrize("spec", ["relaxed", "enhanced", "auto_relaxed"])
def test_reduced_discontinuities(spec: str, tracing: Tracing) -> None:
    """Keinert 2014, section 3.4: over the hits, the spread of how far f is from the tolerance falls."""
    spread = {}
    for way in (0, 1, 2):
        compiled = compile_scene(compiled_file(SCENES / "csg5.sdf").scene, Options(f"{spec}:reduce={way}"))
        with tracing.renderer.prepared(Shot(compiled, View(), {}, (160, 90)), "depth") as prepared:
            pixel = prepared.uniforms["pixel"]
            assert isinstance(pixel, tuple)
            prepared.uniforms["pixel"] = (0.0, 4.0 * pixel[1], pixel[2])
            prepared.draw()
            depth, _, _, hit = np.moveaxis(prepared.read().astype(float), -1, 0)
        picture = tracing.picture(compiled, (160, 90))
        steps = np.where(hit > 0.5, depth, np.nan).ravel() / compiled.plan.radius
        target = 4.0 * FINE * pixel[1] * steps
        value = residuals(compiled, picture.o + steps * picture.d)
        good = np.isfinite(steps) & (np.abs(value) < 4.0 * target)
        assert good.sum() > 0.98 * (hit > 0.5).sum()
        spread[way] = float(np.std((value[good] - target[good]) / target[good]))
    print(spec, spread)
    assert spread[1] < 0.5 * spread[0] and spread[2] < spread[0]


def residuals(compiled: Compiled, p: np.ndarray) -> np.ndarray:
    """The field at points (3, n) of the scene's own coordinates, in float64; NaN at NaN."""
    params = {param.name: param.default for param in compiled.scene.params}
    (values,) = Evaluator([lower(compiled.shape, compiled.scene.values.input("p"))])({"p": p}, params)
    return np.asarray(values)


@pytest.mark.parametrize("spec", [*PUBLISHED, "sphere"])
def test_what_is_given_up_is_said(spec: str, tracing: Tracing) -> None:
    """With too few passes: no ray that finished is wrong, and every ray that did not says so."""
    full = every(tracing.picture(scene("csg5.sdf", spec), SIZE), 10**6)
    short = tracing.picture(scene("csg5.sdf", spec, most_steps=16), SIZE)
    assert 0 < short.unfinished.sum() < 0.5 * short.hit.size
    done = ~short.unfinished & ~full.unfinished
    np.testing.assert_array_equal(short.hit[done], full.hit[done])
    both = done & full.hit
    assert np.allclose(short.depth[both], full.depth[both], atol=1e-6)


def test_candidates_fill_the_holes(tracing: Tracing) -> None:
    """Keinert 2014, section 3.2: where the passes run out at a silhouette the nearest point is taken, if it is near."""
    full = tracing.picture(scene("csg5.sdf", "relaxed"), SIZE)
    answers = {f: tracing.picture(scene("csg5.sdf", f"relaxed:force={f}", most_steps=16), SIZE) for f in (0, 1, 1e9)}
    given_up = answers[0].unfinished
    lost = {f: int((given_up & full.hit & ~a.hit).sum()) for f, a in answers.items()}
    assert not (answers[0].hit & given_up).any(), "a candidate that is no nearer than nothing"
    assert lost[1e9] < lost[0], lost
    assert (answers[1].hit <= answers[1e9].hit).all()


@pytest.mark.parametrize("name", ["rods", "csg5.sdf"])
def test_what_liktor_loses_is_shallow(name: str, tracing: Tracing) -> None:
    """ALGORITHMS T9: with so long a least step rods are lost, but nothing that is deeper than half of it anywhere."""
    spec = "liktor:min_step=16"
    proved = known(name, tracing, 16.0)
    _, picture = told(name, spec, tracing)
    assert wrong(picture, proved.truth).size == 0
    if name == "rods":
        plain = known(name, tracing)
        assert wrong(picture, plain.truth).size > 0, "nothing is lost: the test has no teeth"


@pytest.mark.parametrize("spec", ["sphere", *PUBLISHED])
@pytest.mark.parametrize("name", ["csg5.sdf", "heart.sdf"])
def test_pictures_are_those_of_proven(name: str, spec: str, tracing: Tracing) -> None:
    """What bounds a part's distance to march it does not show as a shadow of its box, wherever the light comes from."""
    ours, theirs = (
        tracing.renderer.radiance(Shot(scene(name, s), View(), {}, SIZE), 0, None).astype(float)
        for s in ("proven", spec)
    )
    assert (np.abs(ours - theirs).max(axis=-1) > 0.02).mean() < 0.05  # what is early at edges


def test_points_below_the_surface_are_no_shadow(tracing: Tracing) -> None:
    """Keinert 2014, section 3.3: shadow rays clear the surface by twice what the hit is off, not by a constant."""
    text = "scene { sphere(radius: 1) sphere(radius: 0.1).translate([0, 1.1, 0]) }\n"  # alone it would cast no shadow
    text += "light sun { direction: [-0.2, -0.3, -1], intensity: 3 }\n"
    text += "camera { eye: [0, 0, 6], target: [0, 0, 0], fov: 30deg }"
    lit = compiled_text(text).scene
    rough = compile_scene(
        lit, Options("liktor:min_step=8:refinements=0")
    )  # whose hits are as much as half a pixel deep
    constant, count = re.subn(
        r"lift = clearance\(.*\);",
        f"lift = max({LIFT}, 4.0 * tolerance(0.0));",
        rough.glsl("radiance", near_eye=True),  # what an eye so near is drawn with
    )
    assert count == 1
    printed = replace(rough, _texts={("radiance", "fragment", True): constant})
    exact, ours, theirs = (
        tracing.renderer.radiance(Shot(c, View(), {}, SIZE), 0, None).astype(float)
        for c in (compile_scene(lit, Options()), rough, printed)
    )
    inner = (exact[..., 3] > 0.5) & (ours[..., 3] > 0.5)
    assert inner.sum() > 500
    black = [int((np.abs(seen - exact)[inner][:, :3].max(axis=1) > 0.1).sum()) for seen in (ours, theirs)]
    assert black[0] == 0 and black[1] > 100, black
