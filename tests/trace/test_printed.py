"""What is wrong with the listings as printed goes wrong (in float32, tests/trace/printed.py), and does not with ours.

Numbers are the rows of the table in ALGORITHMS A1. Row 6 (the radius that a failed look leaves behind) is harmless as
printed, since no step that goes back can fail again; row 9 is of the text, equation 1, not of the listing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import moderngl
import numpy as np
import printed
import pytest
from aimed import Aimed, aim, compiled, own
from numpy.typing import NDArray

from sdfc.pipeline import Compiled
from sdfc.plan.plan import FINE

pytestmark = pytest.mark.gpu

Array: TypeAlias = NDArray[np.float64]

OVERSTEPPING = ("relaxed:omega=1.6", "enhanced", "auto_relaxed")
PIXEL = 1e-4  # what the listing takes for half a pixel, and ours for the tolerance: growth with t
CONE = (0.0, PIXEL / FINE)
BALLS = (((0.0, 0.0, 0.0), 1.0), ((1.3, 0.4, 0.6), 0.5), ((-0.9, 0.9, 1.0), 0.4), ((0.2, -0.8, 1.2), 0.3))
SOLID = " ".join(f"sphere(radius: {r}).translate([{x}, {y}, {z}])" for (x, y, z), r in BALLS)
TEXT = f"scene {{ {SOLID} }}"


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene of balls, in its own coordinates."""

    compiled: Compiled
    centres: Array
    radii: Array

    @classmethod
    def of(cls, spec: str, most_steps: int | None = None) -> Scene:
        scene = compiled(TEXT, spec, most_steps)
        centres = (np.array([c for c, _ in BALLS]) - np.array(scene.frame.centre)) / scene.frame.radius
        return cls(scene, centres, np.array([r for _, r in BALLS]) / scene.frame.radius)

    def distance(self, p: NDArray[np.float32]) -> float:
        return float((np.linalg.norm(p - self.centres, axis=1) - self.radii).min())

    def first(self, o: Array, d: Array) -> Array:
        """Where rays (3, n) enter the first ball, in closed form; inf where none."""
        offset = o[:, :, None] - self.centres.T[:, None, :]
        half = (offset * d[:, :, None]).sum(axis=0)
        rest = half**2 - (offset**2).sum(axis=0) + self.radii**2
        enter = np.where(rest > 0.0, -half - np.sqrt(np.maximum(rest, 0.0)), np.inf)
        return np.where(enter > 0.0, enter, np.inf).min(axis=1)


def rays(seed: int, count: int) -> tuple[Array, Array]:
    """From around the scene's unit ball into it, in float32 numbers."""
    random = np.random.default_rng(seed)
    o = random.normal(size=(3, count))
    o *= 2.5 / np.linalg.norm(o, axis=0)
    d = random.uniform(-0.7, 0.7, (3, count)) - o
    d /= np.linalg.norm(d, axis=0)
    return o.astype(np.float32).astype(float), d.astype(np.float32).astype(float)


def one(*p: float) -> Array:
    return np.array(p, float)[:, None]


def as32(v: Array) -> NDArray[np.float32]:
    return v[:, 0].astype(np.float32)


@pytest.mark.parametrize("spec", OVERSTEPPING)
def test_row_1_a_far_plane_behind_the_surface(gl: moderngl.Context, spec: str) -> None:
    """A look too far that failed may lie beyond the far plane: that is no miss."""
    scene = Scene.of(spec)
    o, d = rays(1, 400)
    truth = scene.first(o, d)
    o, d, truth = (v[..., np.isfinite(truth)] for v in (o, d, truth))
    ours = aim(gl, scene.compiled, o, d, 0.0, truth + 0.05, cone=CONE)
    assert ours.hit.all() and (np.abs(ours.t - truth) < 0.02).all()
    theirs = [
        printed.keinert(
            scene.distance, *(v[:, i].astype(np.float32) for v in (o, d)), t_max=t + 0.05, pixel_radius=PIXEL, omega=1.6
        )
        for i, t in enumerate(truth)
    ]
    assert np.mean([not told.hit for told in theirs]) > 0.02


def grazing(gl: moderngl.Context, spec: str) -> tuple[Scene, printed.Told, Aimed]:
    """A ray that passes the large ball closely."""
    scene = Scene.of(spec)
    o = one(-2.0, 0.0, 0.0) + scene.centres[0][:, None] + one(0.0, 0.0, -1.005 * scene.radii[0])
    d = one(1.0, 0.0, 0.0)
    return scene, printed.keinert(scene.distance, as32(o), as32(d), omega=1.6), aim(gl, scene.compiled, o, d)


def after_failure(scene: Scene, looks: Array) -> tuple[float, list[float]]:
    """In radii of the last ball that was taken: where the first failed look falls back to; and the later steps."""
    o = one(-2.0, 0.0, 0.0) + scene.centres[0][:, None] + one(0.0, 0.0, -1.005 * scene.radii[0])
    radius = [scene.distance(as32(o + t * one(1.0, 0.0, 0.0))) for t in looks]
    (back, *_) = np.flatnonzero(np.diff(looks) < 0.0)
    later = [(looks[i + 1] - looks[i]) / radius[i] for i in range(back + 1, len(looks) - 1)]
    return (looks[back + 1] - looks[back - 1]) / radius[back - 1], later


def test_rows_2_and_3_the_way_back_and_on(gl: moderngl.Context) -> None:
    """A failed look goes back to the ball's edge, not before it; and the next one looks ahead again."""
    scene, theirs, ours = grazing(gl, "relaxed:omega=1.6")
    fallback, later = after_failure(scene, np.array(theirs.looks))
    assert fallback == pytest.approx(1.6 * (2.0 - 1.6), rel=1e-3)
    assert max(later) < 1.001
    looks = ours.looks[:, 0]
    fallback, later = after_failure(scene, looks[np.isfinite(looks)])
    assert fallback == pytest.approx(1.0, rel=1e-3)
    assert max(later) == pytest.approx(1.6, rel=1e-3)


@pytest.mark.parametrize("spec", OVERSTEPPING)
def test_row_4_a_start_outside_a_ray_from_inside(gl: moderngl.Context, spec: str) -> None:
    """The side is that of where the ray starts, not of where its parameter is 0."""
    scene = Scene.of(spec)
    o, d = scene.centres[0][:, None], (scene.centres[2] - scene.centres[0])[:, None]
    away = float(np.linalg.norm(d))
    d = d / away
    start, truth = scene.radii[0] + 1e-3, away - scene.radii[2]
    ours = aim(gl, scene.compiled, o, d, start, cone=CONE)
    assert ours.t[0] == pytest.approx(truth, abs=1e-3)
    theirs = printed.keinert(scene.distance, as32(o), as32(d), t_min=start, t_max=9.0, pixel_radius=PIXEL)
    assert not (theirs.hit and abs(theirs.t - truth) < 1e-2)


@pytest.mark.parametrize("spec", OVERSTEPPING)
def test_row_5_a_start_on_the_surface(gl: moderngl.Context, spec: str) -> None:
    """0 / 0 at t = 0 is below no tolerance: the listing stays there until it gives up, and finds nothing."""
    scene = compiled("scene { sphere(radius: 1) sphere(radius: 1).translate([0, 0, -3]) }", spec)
    o, d = own(scene, one(0.0, 0.0, 1.0), one(0.0, 0.0, -1.0))
    assert aim(gl, scene, o, d, cone=CONE).t[0] == pytest.approx(0.0, abs=1e-5)
    theirs = printed.keinert(lambda p: float(np.linalg.norm(p)) - 1.0, np.float32([0, 0, 1]), np.float32([0, 0, -1]))
    assert not theirs.hit and set(theirs.looks) == {0.0}


@pytest.mark.parametrize("spec", OVERSTEPPING)
def test_row_7_a_field_that_is_no_bound(gl: moderngl.Context, spec: str) -> None:
    """A claim that is false: the field falls twice as fast as a distance. Ours narrows the change of sign it meets."""
    text = "field steep() = 2 * length(p) - 2 lipschitz 1 bounds [-1, -1, -1] .. [1, 1, 1]\nscene { steep() }"
    scene = compiled(text, spec)
    o, d = own(scene, one(0.3, 0.2, 1.3), one(0.0, 0.0, -1.0))
    ours = aim(gl, scene, o, d, cone=CONE)
    truth = 1.3 - np.sqrt(1.0 - 0.3**2 - 0.2**2)
    assert ours.t[0] * scene.frame.radius == pytest.approx(truth, abs=1e-3)
    theirs = printed.keinert(
        lambda p: 2.0 * float(np.linalg.norm(p)) - 2.0,
        np.float32([0.3, 0.2, 1.3]),
        np.float32([0, 0, -1]),
        pixel_radius=PIXEL,
    )
    assert not (theirs.hit and abs(theirs.t - truth) < 1e-2)
    assert min(np.diff(theirs.looks)) < -0.5, "it swings to and fro"


@pytest.mark.parametrize("spec", [f"{s}:force=1e9" for s in OVERSTEPPING])
def test_row_8_a_candidate_at_the_start(gl: moderngl.Context, spec: str) -> None:
    """A ray that leaves a surface comes nearest to it where it starts: that is nothing that it could hit."""
    scene = Scene.of(spec, most_steps=6)
    o, d = scene.centres[0][:, None] - one(0.0, 0.0, scene.radii[0] + 1e-5), one(0.8, 0.0, -0.6)
    ours = aim(gl, scene.compiled, o, d, 1e-2, cone=CONE)
    assert not ours.hit[0] or ours.t[0] > 0.1
    theirs = printed.keinert(scene.distance, as32(o), as32(d), t_min=1e-2, pixel_radius=PIXEL, most=6, force_hit=True)
    assert theirs.t == pytest.approx(1e-2)


def test_row_10_holes_where_the_passes_run_out(gl: moderngl.Context) -> None:
    """With few passes the listing misses what is there without a word. Ours says so, and takes what is near a pixel."""
    full = Scene.of("relaxed:omega=1.6")
    o, d = rays(2, 600)
    truth = full.first(o, d)
    o, d, truth = (v[..., np.isfinite(truth)] for v in (o, d, truth))
    few = Scene.of("relaxed:omega=1.6", most_steps=7)
    ours = aim(gl, few.compiled, o, d, cone=CONE)
    assert not (~ours.hit & ~ours.unfinished).any()
    theirs = [
        printed.keinert(
            few.distance, *(v[:, i].astype(np.float32) for v in (o, d)), pixel_radius=PIXEL, omega=1.6, most=7
        )
        for i in range(truth.size)
    ]
    holes = np.array([not told.hit for told in theirs])
    assert holes.sum() > 5
    assert (ours.hit & ours.unfinished).sum() > 0, "no candidate was near a pixel"


def test_balls_that_meet_exactly(gl: moderngl.Context) -> None:
    """Before a plane the next ball touches this one: what rounding makes of that is no reason to go back."""
    heights = np.random.default_rng(3).uniform(0.5, 3.0, 60)
    slants = np.random.default_rng(4).uniform(0.2, 0.95, 60)

    def goes_back(height: float, slant: float) -> bool:
        return bool(min(np.diff(printed.enhanced(lambda t: height - slant * t, 100.0).looks)) < 0.0)

    assert np.mean([goes_back(h, c) for h, c in zip(heights, slants, strict=True)]) > 0.2
    scene = compiled("scene { plane(normal: [0, 1, 0]) sphere(radius: 1).translate([0, -3, 0]) }", "enhanced:omega=1")
    o = np.stack([np.zeros(60), heights, np.zeros(60)])
    d = np.stack([np.sqrt(1.0 - slants**2), -slants, np.zeros(60)])
    o, d = own(scene, o, d)
    looks = aim(gl, scene, o, d, cone=(0.0, 1e-6)).looks
    assert np.mean(np.nanmin(np.diff(looks, axis=0), axis=0) < 0.0) < 0.05


def test_a_least_step_of_segments_loses_what_is_thin(gl: moderngl.Context) -> None:
    """Galin's code steps by epsilon at least, from a value of 0 as well: over a sheet that is thinner."""
    half = 2.0**-12
    text = f"scene {{ box(size: [1, 1, {2 * half}]) box(size: [1, 1, 1]).translate([0, 0, -4]) }}"
    theirs = printed.galin(lambda t: abs(t - 2.0 - half) - half, lambda t, u: 1.0, 0.0, 4.0, epsilon=1e-3)
    assert not theirs.hit
    for spec in ("segment", "segment:symmetric=1"):
        scene = compiled(text, spec)
        o, d = own(scene, one(0.1, 0.1, 2.0 + half), one(0.0, 0.0, -1.0))
        assert aim(gl, scene, o, d, cone=(0.0, 1e-4)).t[0] * scene.frame.radius == pytest.approx(2.0, abs=1e-4)


GAP = "scene { box(size: [2, 2, 1]).translate([0, 0, 0.505]) box(size: [2, 2, 1]).translate([0, 0, -0.52]) }"


def gap(t: float) -> float:
    return min(t + 0.005, 0.02 - t)


def test_an_outside_point_that_was_not_looked_at(gl: moderngl.Context) -> None:
    """Liktor takes what lies four deltas before his inside point for outside: here that is the wall behind."""
    assert not printed.liktor(gap, 1.0, delta=0.01, looks_again=False).hit, "f1 is the value before the overshoot"
    theirs = printed.liktor(gap, 1.0, delta=0.01)
    assert abs(theirs.t - 0.02) > 0.01
    for spec in ("liktor", "liktor:min_step=40", "liktor:plain=1:min_step=40"):
        scene = compiled(GAP, spec)
        o, d = own(scene, one(0.0, 0.0, 0.0), one(0.0, 0.0, -1.0))
        ours = aim(gl, scene, o, d, cone=(1e-4, 1e-3))
        assert ours.t[0] * scene.frame.radius == pytest.approx(0.02, abs=1e-5)


def test_regula_falsi_stalls(gl: moderngl.Context) -> None:
    """A field that bends along the ray: one end of plain regula falsi stays where it is, and with it the error."""
    power, before = 6, 0.3
    text = f"field bent() = (pow(length(p), {power}) - 1) / {power} lipschitz 1 bounds [-1, -1, -1] .. [1, 1, 1]"
    sides = np.linspace(0.0, 0.7, 40)
    error = {}
    for plain in (0, 1):
        scene = compiled(f"{text}\nscene {{ bent() }}", f"liktor:min_step=1000:refinements=8:plain={plain}")
        top = np.sqrt(1.0 - sides**2)
        o, d = own(scene, np.stack([sides, 0.0 * sides, top + before]), one(0.0, 0.0, -1.0))
        ours = aim(gl, scene, o, d, cone=(4e-4, 0.0))
        assert ours.hit.all()
        error[plain] = np.abs(ours.t * scene.frame.radius - before)
    print({plain: (np.median(e), e.max()) for plain, e in error.items()})
    assert error[0].max() < 1e-4 and error[1].max() > 100.0 * error[0].max()
