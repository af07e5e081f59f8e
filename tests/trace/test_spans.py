"""Law: fields that are stepped by bounds over the piece of the ray ahead are hit where they are, however flat."""

from __future__ import annotations

import numpy as np
import pytest
from truth import Tracing, certified, compiled_text, every, footprint, wrong

from sdfc.diagnostics import SceneError
from sdfc.facts.rule import Rule, Rules
from sdfc.field.piece import SHORT, look
from sdfc.measure.judge import near_enough
from sdfc.pipeline import Compiled
from sdfc.plan.candidates import UNMEASURED, candidates
from sdfc.plan.plan import FINE, SMALLEST_TOLERANCE
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.trace import Array, StepTracer
from sdfc.shape.lower import FAR

pytestmark = pytest.mark.gpu

SIZE = (64, 36)
CAMERA = "camera { eye: [2, 2, 3.2], target: [0, 0, 0], fov: 36deg }\n"
WAVES = "max(abs(p.y + 0.15 * sin(7 * p.x) * sin(5 * p.z)) - 0.1 - 0.2 * smoothstep(0.2, 0.4, p.x), {} - 0.9)"
STAR = """field star() = sqrt(abs(p.x)) + sqrt(abs(p.y)) + sqrt(abs(p.z)) - 1.3
    bounds [-1.7, -1.7, -1.7] .. [1.7, 1.7, 1.7]
"""
CHOSEN = {
    "a cliff": "field cliff() = p.y - smoothstep(0, 0.001, p.x) * 0.4\nscene { cliff() & box(size: 1.6) }",
    "a cliff in its own box": """field cliff() = max(p.y - smoothstep(0, 0.01, p.x) * 0.4, sides)
        where sides = max(abs(p.x), max(abs(p.z), -p.y)) - 0.9
        bounds [-1, -1, -1] .. [1, 1, 1]
    scene { cliff() }""",
    "waves": f"field waves() = {WAVES.format('max(abs(p.x), abs(p.z))')} bounds [-1, -0.6, -1] .. [1, 0.6, 1]\n"
    "scene { waves().rotate(z: 20deg).scale([1.2, 1, 0.8]) }",
}
UNKNOWN = {
    "a star": STAR + "scene { star() }",
    "a star, turned": STAR + "scene { star().rotate(x: 20deg, y: 10deg).scale(0.8) }",
    "a star cut": STAR + "scene { star() & box(size: [1.2, 1.2, 1.2]) }",
    "a star cut away": STAR + "scene { box(size: [1.2, 1.2, 1.2]) - star().translate([0.5, 0.5, 0.5]) }",
    "a star among others": STAR + "scene { star() sphere(radius: 0.3).translate([0.6, 0.6, 0.6]) }",
    "a star, blended": STAR + "scene { smooth_union(0.2) { star() sphere(radius: 0.5).translate([0.6, 0.6, 0.6]) } }",
}
FORCED = {
    "a twisted union": "scene { (box(size: [0.6, 1.6, 0.6]) | sphere(radius: 0.4).translate([0.4, 0, 0])).twist(1rad)}",
    "a repeated warp": "scene { box(size: [0.3, 1, 0.3]).twist(100deg).repeat([0.8, 4, 0.8], count: [3, 1, 3]) }",
    "cut away": "scene { box(size: 1.2) - sphere(radius: 0.7).displace(amplitude: 0.05, wavelength: 0.3) }",
}
ALL = CHOSEN | UNKNOWN | FORCED


@pytest.fixture
def as_the_table_says(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """By pieces, where another rule would be chosen too."""
    if name in FORCED:
        monkeypatch.setattr(Rules, "best", lambda self, *asked: Rule(by_pieces=True))


def by_pieces(compiled: Compiled) -> int:
    return sum(isinstance(leaf, Ball) and bool(leaf.ahead) for leaf in leaves_of(compiled.plan.root))


def near(depth: Array, cone: tuple[float, float]) -> Array:
    """What counts as there, as a length along the ray."""
    return np.maximum(SMALLEST_TOLERANCE * np.maximum(1.0, depth), FINE * (cone[0] + cone[1] * depth))


@pytest.mark.usefixtures("as_the_table_says")
@pytest.mark.parametrize("name", ALL)
def test_hits_are_where_the_truth_is(name: str, tracing: Tracing, is_full: bool) -> None:
    """Along the ray, to a few times what counts as there: whatever the field's constant is."""
    compiled = compiled_text(CAMERA + ALL[name])
    assert by_pieces(compiled) == 1, compiled.explanation()
    picture = tracing.picture(compiled, SIZE)
    assert 0.02 < picture.hit.mean() < 0.98
    assert not picture.unfinished.any()
    some = every(picture, picture.hit.size if is_full else 250)
    cone = footprint(compiled, SIZE)
    truth = certified(compiled, some, 2.0 * near_enough(compiled, some, cone))
    bad = wrong(some, truth)
    assert not bad.size, f"o {some.o[:, bad[:3]].T}, d {some.d[:, bad[:3]].T}"
    sure = some.hit & ~truth.contested & (truth.status == 1)
    assert sure.sum() > 10
    eps = near(some.depth, cone)
    off = np.maximum(truth.t_lo - some.depth, some.depth - truth.t_hi)
    assert (off[sure] <= (SHORT + 1.0) * eps[sure]).all(), f"{np.max(off[sure] / eps[sure])} tolerances"


@pytest.mark.parametrize("name", CHOSEN)
def test_they_are_chosen_and_take_fewer_steps(name: str, tracing: Tracing, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = compiled_text(CAMERA + CHOSEN[name])
    assert by_pieces(chosen) == 1
    assert "bounds of its slope over the piece of the ray ahead" in chosen.explanation()
    monkeypatch.setattr(Rules, "best", lambda self, *asked: Rule())
    balls = compiled_text(CAMERA + CHOSEN[name])
    assert by_pieces(balls) == 0
    fast, slow = tracing.picture(chosen, SIZE), tracing.picture(balls, SIZE)
    assert fast.steps.sum() < 0.6 * slow.steps.sum()
    assert fast.steps.max() < slow.steps.max()


@pytest.mark.usefixtures("as_the_table_says")
@pytest.mark.parametrize("name", ALL)
def test_the_float64_twin_agrees(name: str, tracing: Tracing) -> None:
    compiled = compiled_text(CAMERA + ALL[name])
    picture = tracing.picture(compiled, SIZE)
    formulas = Formulas(compiled.scene.values, {}, compiled.plan.materials, compiled.setting.unpainted)
    rays = Rays(picture.o, picture.d, np.zeros(picture.hit.size), footprint(compiled, SIZE))
    start, end = np.zeros(picture.hit.size), np.full(picture.hit.size, FAR)
    found, steps = StepTracer(compiled.plan, formulas).first(rays, start, end)
    hit = found < FAR
    assert (hit != picture.hit).mean() < 0.01
    both = hit & picture.hit
    off = np.abs(found - picture.depth)[both] / near(picture.depth[both], rays.cone)
    assert np.median(off) < SHORT and np.quantile(off, 0.98) < 2.0 * SHORT
    assert steps.max() < 200


def test_without_a_constant_tracers_of_distances_are_illegal() -> None:
    compiled = compiled_text(CAMERA + UNKNOWN["a star"])
    found = candidates(compiled.plan, compiled.scene.values, UNMEASURED)
    assert {c.tracer for c in found if not c.illegal} == {"proven"}
    assert all("no Lipschitz constant is known for star_1" in c.illegal for c in found if c.tracer != "proven")
    with pytest.raises(SceneError, match="no bound of the slope of 'star'"):
        compiled_text(CAMERA + UNKNOWN["a star"], "sphere")


@pytest.mark.parametrize(
    "formula",
    [
        "p.y - 0.2 * floor(5 * p.x)",
        "sqrt(abs(mod(p.x, 0.5) - 0.25)) + abs(p.y) - 0.4",
        "length(p) - 1 / abs(p.x)",
        "p.y + sign(p.z - 0.31) * 0.3",
    ],
)
def test_what_may_jump_is_refused(formula: str) -> None:
    """Where cells of a repetition meet, all of a cell is met: nothing may be proved there."""
    with pytest.raises(SceneError, match="no bound of the slope of 'wild'"):
        compiled_text(CAMERA + f"field wild() = {formula} bounds [-1, -1, -1] .. [1, 1, 1]\nscene {{ wild() }}")


def test_no_look_passes_a_root() -> None:
    """Of parabolas with their exact spans, at any length of the piece; and every one that has a root is found there."""
    random = np.random.default_rng(5)
    count, eps = 4000, np.full(4000, 1e-6)
    value, slope, bend = random.uniform(0.1, 2.0, count), random.normal(size=count), 2.0 * random.normal(size=count)
    inside = slope * slope - 2.0 * value * bend
    with np.errstate(all="ignore"):
        roots = np.stack([(-slope + sign * np.sqrt(inside)) / bend for sign in (-1.0, 1.0)])
    first = np.where(roots > 0.0, roots, np.inf).min(axis=0)  # NaN is not above 0
    t, length, done = np.zeros(count), random.uniform(1e-5, 10.0, count), np.zeros(count, bool)
    for _ in range(60):
        here, rise = value + t * (slope + 0.5 * bend * t), slope + bend * t
        ends = rise, rise + bend * length
        there = here + length * (rise + 0.5 * bend * length)
        with np.errstate(all="ignore"):
            turn = np.where(ends[0] * ends[1] < 0.0, here - 0.5 * rise * rise / bend, here)
        values = np.stack([here, there, turn])
        span = values.min(axis=0), values.max(axis=0), np.minimum(*ends), np.maximum(*ends)
        clear, found, length = look(length, here, span, np.inf, np.zeros(count), eps)
        done |= found
        t = np.where(done, t, t + clear)
        assert (t <= first + 1e-9).all()
    assert (first[done] - t[done] <= SHORT * 1e-6).all()
    assert done[first < 1e3].all()


def test_a_root_of_third_order_is_where_it_is(tracing: Tracing) -> None:
    """A field that is flat at its surface: the ball of radius 1, which balls of its constant swell by a tenth."""
    product = " * ".join(["(length(p) - 1)"] * 3)
    text = f"field flat() = {product} bounds -[1.2, 1.2, 1.2]..[1.2, 1.2, 1.2]\nscene {{ flat() }}"
    picture = tracing.picture(compiled_text(text), (48, 32))
    scale = 1.0 / compiled_text(text).plan.radius
    near = np.linalg.norm(np.cross(picture.o.T, picture.d.T), axis=1)
    assert picture.hit[near < 0.99 * scale].all() and not picture.hit[near > 1.01 * scale].any()
    along = -(picture.o * picture.d).sum(axis=0)
    truth = along - np.sqrt(np.maximum(scale**2 - near**2, 0.0))
    inner = near < 0.9 * scale
    assert np.abs(picture.depth - truth)[inner].max() < 5e-3 * scale
