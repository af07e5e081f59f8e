"""Law: what is chosen is legal; predictions follow the work; explanations say what was tried and what was left out."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

import sdfc
from sdfc import pipeline
from sdfc.api import choose
from sdfc.api.renderer import GlRenderer
from sdfc.diagnostics import Source
from sdfc.plan.candidates import UNMEASURED, Candidate, candidates
from sdfc.plan.plan import Plan
from sdfc.scene.model import Scene
from sdfc.tracers import TRACERS

SCENES = Path(__file__).parents[2] / "scenes"
HARD = "scene { box(size: [1, 1, 1]) - sphere(radius: 0.6) }"
SOFT = "scene { union(blend: 0.3) { sphere(radius: 0.5) box(size: [1.4, 0.2, 0.2]) } }"
RING = "scene { torus(major: 1, minor: 0.2) }"
STEEP = """field steep(reach: length > 0) = exp(p.x * 40) * (length(p) - reach) {
    bounds -[reach, reach, reach] .. [reach, reach, reach]
}
scene { steep(reach: 1) }
"""


def scene(text: str) -> Scene:
    return pipeline.load(Source("test.sdf", text))


def plan_of(text: str) -> tuple[Plan, Scene]:
    loaded = scene(text)
    return pipeline.compile_scene(loaded).plan, loaded


def ways(text: str) -> list[Candidate]:
    plan, loaded = plan_of(text)
    return candidates(plan, loaded.values, UNMEASURED)


@pytest.fixture
def renderer(opengl: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[GlRenderer]:
    """OpenGL, and a cache of its own."""
    monkeypatch.setenv("SDFC_CACHE_DIR", str(tmp_path))
    with contextlib.closing(GlRenderer()) as made:
        yield made


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.sdf")), ids=lambda p: p.stem)
def test_every_tracer_is_a_candidate_and_one_at_least_is_legal(path: Path) -> None:
    loaded = pipeline.load(Source(path.name, path.read_text()), path.parent)
    with pipeline.deep_recursion():
        found = candidates(pipeline.compile_scene(loaded).plan, loaded.values, UNMEASURED)
    assert {c.tracer for c in found} == set(TRACERS)
    assert not found[0].illegal and found[0].milliseconds > 0.0
    legal = [c.milliseconds for c in found if not c.illegal]
    assert legal == sorted(legal)
    weak = {name for name, tracer in TRACERS.items() if tracer.weak}
    assert all(c.illegal for c in found if c.tracer in weak)


def test_what_has_no_lipschitz_constant_is_for_no_tracer_of_distances(monkeypatch: pytest.MonkeyPatch) -> None:
    plan, loaded = plan_of(RING)
    unbounded = replace(plan, slopes=dict.fromkeys(plan.slopes, float("inf")))
    found = candidates(unbounded, loaded.values, UNMEASURED)
    illegal = {c.tracer for c in found if c.illegal}
    assert illegal == {name for name, tracer in TRACERS.items() if not tracer.needs_steps}
    assert all("no Lipschitz constant" in c.illegal for c in found if c.tracer in ("sphere", "relaxed"))
    assert not unbounded.can_sweep


def test_more_of_a_scene_is_predicted_to_take_longer() -> None:
    one, four = "sphere(radius: 0.3)", " ".join(f"box(size: [{n}, 1, 1])" for n in (1.1, 1.2, 1.3, 1.4))
    for tracer in ("proven", "sphere"):
        times = [
            next(c.milliseconds for c in ways(f"scene {{ {body} }}") if c.tracer == tracer and not c.prepass)
            for body in (one, f"{one} {four}")
        ]
        assert times[0] < times[1]


def test_hard_csg_is_never_marched() -> None:
    best = ways(HARD)[0]
    assert (best.tracer, best.prepass, best.passes) == ("proven", False, 0.0)
    assert not any(c.prepass for c in ways(HARD) if c.tracer == "proven"), "there is nothing to sweep for"


@pytest.mark.gpu
def test_close_predictions_are_decided_by_a_pilot_that_is_remembered(
    renderer: GlRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    decision = choose.decide(scene(SOFT), renderer, pilot=True)
    assert len(decision.pilot) > 1 and decision.chosen.name in decision.pilot
    assert decision.pilot[decision.chosen.name] <= 1.1 * min(decision.pilot.values())
    monkeypatch.setattr(choose, "_timed", lambda _: pytest.fail("drawn again"))
    monkeypatch.setattr("sdfc.gpu.calibrate.calibrate", lambda *_: pytest.fail("measured again"))
    again = choose.decide(scene(SOFT), renderer, pilot=False)
    assert again.chosen == decision.chosen and again.pilot == decision.pilot


@pytest.mark.gpu
def test_a_pilot_does_not_choose_what_draws_another_picture(
    renderer: GlRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def blind(candidate: Candidate) -> pipeline.Options:
        return pipeline.Options(tracer="sphere", most_steps=2) if candidate.prepass else pipeline.Options()

    monkeypatch.setattr(choose, "options_of", blind)
    decision = choose.decide(scene(SOFT), renderer, pilot=True)
    assert not decision.chosen.prepass and not any("prepass" in name for name in decision.pilot)


def test_without_a_device_the_prediction_decides() -> None:
    decision = choose.decide(scene(SOFT), None, pilot=True)
    assert decision.pilot == {} and decision.chosen == next(c for c in decision.candidates if not c.illegal)


@pytest.mark.gpu
def test_little_work_is_not_worth_a_pilot(renderer: GlRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choose, "decide", lambda *_, **__: pytest.fail("decided"))
    with sdfc.compile(SOFT) as program:
        assert program.render((24, 16), backend="gl").size == (24, 16)


@pytest.mark.gpu
def test_much_work_is_traced_as_decided(renderer: GlRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choose, "WORTH_A_PILOT", 1)
    with sdfc.compile(SOFT) as program, sdfc.compile(SOFT) as plain:
        decided = program.render((48, 32), backend="gl")
        monkeypatch.setattr(choose, "WORTH_A_PILOT", 10**12)
        assert (decided.depth == plain.render((48, 32), backend="gl").depth).mean() > 0.95


def test_the_explanation_tells_choice_reasons_and_what_was_left_out() -> None:
    text = (
        "param unused = 1 in 0..2\n"
        "scene { (box(size: [1, 1, 1]) - sphere(radius: 0.1).translate([9, 0, 0])) sphere(radius: 0.4 + 0 * unused) }"
    )
    with sdfc.compile(text) as program:
        told = program.explanation()
    assert "chosen: proven" in told and "candidates, for a million pixels" in told
    assert "1 of 3 parts, which are proved to change nothing" in told
    assert "marching and its tolerances: every part is solved in closed form" in told
    assert "param unused: nothing that is left depends on it" in told
    refused = ", ".join(
        line.partition(": not chosen")[0].strip() for line in told.splitlines() if ": not chosen" in line
    )
    assert set(refused.split(", ")) == {name for name, tracer in TRACERS.items() if tracer.weak}


def test_each_reason_is_told_once() -> None:
    with sdfc.compile("scene { box(size: [1, 1, 1]) }") as program:
        told = [line.partition(": not chosen: ")[2] for line in program.explanation().splitlines()]
    lines = [line for line in told if line]
    assert lines and len(set(lines)) == len(lines)
    for line in lines:
        whys = [reason.partition(": ")[2] for reason in line.split("; ")]
        assert len(set(whys)) == len(whys)


def test_a_part_too_small_for_float32_is_told() -> None:
    small, large = "sphere(radius: 1)", "box(size: [1e8, 1e8, 1e8]).translate([1e12, 0, 0])"
    with sdfc.compile(f"scene {{ {small} {large} }}") as far, sdfc.compile(f"scene {{ {small} }}") as near:
        assert "warning: sphere_1 is 2 across, but in a scene of radius 5e+11 float32" in far.explanation()
        assert "warning: box" not in far.explanation() and "warning: " not in near.explanation()
