"""Law: fields that are stepped by the parabola below them are traced as proved, and in fewer steps than by balls."""

from __future__ import annotations

import numpy as np
import pytest
from truth import Tracing, certified, compiled_text, every, footprint, tolerance, verdict, wrong

from sdfc.api.request import View
from sdfc.facts.box import Box
from sdfc.facts.rule import Rule, Rules
from sdfc.pipeline import Compiled
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.trace import StepTracer
from sdfc.shape.graph import Apply
from sdfc.shape.lower import FAR

pytestmark = pytest.mark.gpu

SIZE = (64, 36)
CAMERA = "camera { eye: [2.2, 1.5, 3.2], target: [0, 0, 0], fov: 36deg }\n"
BLOBS = """field blobs() = 0.6 - exp(-4 * dot(p, p)) - exp(-4 * dot(q, q)) where q = p - [0.7, 0.2, 0]
    bounds [-1.2, -1.2, -1.2] .. [1.8, 1.2, 1.2]
"""
TEXTS = {
    "twisted": "scene { box(size: [0.6, 2, 0.6]).twist(100deg) }",
    "bent": "scene { box(size: [2, 0.25, 0.8]).bend(50deg) }",
    "rough": "scene { sphere(radius: 1).displace(amplitude: 0.08, wavelength: 0.4) }",
    "rough and cut": "scene { sphere(radius: 1).displace(amplitude: 0.08, wavelength: 0.4) & box(size: 1.2) }",
    "lattice": "scene { gyroid(period: 0.55, thickness: 0.05) & sphere(radius: 1) }",
    "blobs": BLOBS + "scene { blobs() }",
    "waved and turned": "scene { box(size: [0.3, 2, 1.8]).shear_wave().twist(60deg).rotate(x: 30deg, z: 20deg) }",
    "squashed": "scene { box(size: [0.6, 2, 0.6]).round(0.05).twist(80deg).scale([1.4, 0.7, 0.9]) }",
    "live": "param turn = 100deg in -300deg..300deg\nscene { box(size: [0.6, 2, 0.6]).twist(turn) }",
}


# far from the surface, or with a loose bound, balls do as well for less
DO_NOT_PAY = ("rough and cut", "blobs", "waved and turned")


@pytest.fixture
def everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parabolas wherever there is a bound, whether they pay or not."""

    def best(self: Rules, shape: Apply, region: Box, lipschitz: float, inside: bool, is_cut: bool) -> Rule:
        return Rule(self.bends.bound(shape, region) if inside else None)

    monkeypatch.setattr(Rules, "best", best)


@pytest.fixture
def balls_only(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(Rules, "best", lambda self, *asked: Rule())
    return monkeypatch


def known_bends(compiled: Compiled) -> int:
    return sum(isinstance(leaf, Ball) and leaf.bend is not None for leaf in leaves_of(compiled.plan.root))


@pytest.mark.usefixtures("everywhere")
@pytest.mark.parametrize("name", TEXTS)
def test_against_interval_arithmetic(name: str, tracing: Tracing, is_full: bool) -> None:
    compiled = compiled_text(CAMERA + TEXTS[name])
    assert known_bends(compiled) == 1, compiled.explanation()
    picture = tracing.picture(compiled, SIZE)
    assert 0.02 < picture.hit.mean() < 0.98
    some = every(picture, picture.hit.size if is_full else 250)
    cone = footprint(compiled, SIZE)
    truth = certified(compiled, some, tolerance(compiled, some, cone))
    result = verdict(compiled, some, truth, cone)
    bad = wrong(some, truth)
    assert result.correct, f"{result}\nfirst wrong rays: o {some.o[:, bad[:3]].T}, d {some.d[:, bad[:3]].T}"


@pytest.mark.parametrize("name", DO_NOT_PAY)
def test_they_are_left_where_they_do_not_pay(name: str) -> None:
    assert known_bends(compiled_text(CAMERA + TEXTS[name])) == 0


@pytest.mark.parametrize("name", [n for n in TEXTS if n not in DO_NOT_PAY])
def test_fewer_steps_than_by_balls_and_the_same_hits(
    name: str, tracing: Tracing, balls_only: pytest.MonkeyPatch
) -> None:
    by_balls = compiled_text(CAMERA + TEXTS[name])
    balls_only.undo()
    by_parabolas = compiled_text(CAMERA + TEXTS[name])
    assert known_bends(by_balls) == 0 and known_bends(by_parabolas) == 1
    slow, fast = tracing.picture(by_balls, SIZE), tracing.picture(by_parabolas, SIZE)
    assert fast.steps.sum() < 0.85 * slow.steps.sum()
    assert fast.steps.max() < slow.steps.max()
    assert (slow.hit != fast.hit).mean() < 0.005
    both = slow.hit & fast.hit
    # balls stop a tolerance short of the surface: more along the ray, where they graze
    assert np.quantile(np.abs(slow.depth - fast.depth)[both], 0.9) < 2e-3


@pytest.mark.parametrize("turn", [-300.0, -20.0, 0.0, 170.0])
def test_the_bend_goes_by_the_params(turn: float, tracing: Tracing) -> None:
    """Whatever the value in its range: the picture is that of a scene in which it is a constant."""
    live = compiled_text(CAMERA + TEXTS["live"])
    fixed = compiled_text(CAMERA + f"scene {{ box(size: [0.6, 2, 0.6]).twist({turn}deg) }}")
    given = tracing.picture(live, SIZE, View(), {"turn": (float(np.radians(turn)),)})
    plain = tracing.picture(fixed, SIZE)
    scale = live.plan.radius / fixed.plan.radius
    assert (given.hit != plain.hit).mean() < 0.005
    both = given.hit & plain.hit
    assert both.any()
    if abs(scale - 1.0) < 1e-6:
        assert np.quantile(np.abs(given.depth * scale - plain.depth)[both], 0.9) < 1e-3


@pytest.mark.usefixtures("everywhere")
@pytest.mark.parametrize("name", [n for n in TEXTS if n != "live"])
def test_the_float64_twin_agrees(name: str, tracing: Tracing) -> None:
    compiled = compiled_text(CAMERA + TEXTS[name])
    picture = tracing.picture(compiled, SIZE)
    cone = footprint(compiled, SIZE)
    formulas = Formulas(compiled.scene.values, {}, compiled.plan.materials, compiled.setting.unpainted)
    rays = Rays(picture.o, picture.d, np.zeros(picture.hit.size), cone)
    start, end = np.zeros(picture.hit.size), np.full(picture.hit.size, FAR)
    found, steps = StepTracer(compiled.plan, formulas).first(rays, start, end)
    hit = found < FAR
    assert (hit != picture.hit).mean() < 0.01
    both = hit & picture.hit
    error = np.abs(found - picture.depth)[both]  # of two answers within a tolerance of the surface, which rays graze
    assert np.median(error) < 1e-3 and np.quantile(error, 0.9) < 5e-3
    assert steps.max() < 200
