"""Law: whatever is built of whatever, every tracer agrees with what is proved, and every fact with what is sampled.

A short run holds 500 trees against samples, and traces 200 by `proven` and one other tracer. SDFC_TREE_EXAMPLES=1000
grows so many others for each law, and traces each by every tracer.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, note, seed, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scene_trees import KINDS, VIEWS, scenes, table
from truth import Tracing, compiled_text

from sdfc.api.request import View
from sdfc.diagnostics import SceneError
from sdfc.facts.box import Box, everything
from sdfc.field.numeric import Evaluator
from sdfc.glsl.body import own_point
from sdfc.measure.stress.record import Case
from sdfc.measure.stress.trees import whole
from sdfc.measure.stress.trial import tried
from sdfc.pipeline import Compiled
from sdfc.plan.steps import All, Any, Ball, Blend, Chord, Closed, Leaf, Many, Part, Step, Tangent, Within, leaves_of
from sdfc.shape.lower import lower
from sdfc.tracers import TRACERS

Array = NDArray[np.float64]

MANY = os.environ.get("SDFC_TREE_EXAMPLES")
SIZE = (8, 5)
OTHERS = tuple(name for name in TRACERS if name != "proven")
BATCHES = range(10)
SAMPLED, TRACED = 500 // len(BATCHES), 200 // len(BATCHES)  # a batch


def grown(batch: int, trees: int, law: Callable[..., None]) -> None:
    """The law held against a batch of trees: always the same ones in a short run."""
    forest = settings(
        max_examples=int(MANY) // len(BATCHES) if MANY else trees,
        deadline=None,
        database=None,
        phases=(Phase.explicit, Phase.generate, *((Phase.shrink,) if MANY else ())),
        suppress_health_check=list(HealthCheck),
    )
    (forest(law) if MANY else seed(batch)(forest(law)))()


def check(text: str, view: View, tracing: Tracing, tracers: tuple[str, ...] = ("proven",)) -> None:
    """Nothing is wrong on an uncontested ray. Only `proven` may give none up; others are right where they did not."""
    for name in tracers:
        try:
            compiled = compiled_text(text, name)
        except SceneError as error:
            assert "solid everywhere" in str(error), "every scene of the grammar can be traced by every tracer"
            continue
        (trial,) = tried(tracing, compiled, [Case(name=name, text=text, view=view)], SIZE)
        excused = np.zeros_like(trial.wrong) if name == "proven" else trial.picture.unfinished
        wrong = {kind: np.flatnonzero(mask & ~excused) for kind, mask in trial.kinds.items() if (mask & ~excused).any()}
        places = [(trial.picture.o[:, i[0]].tolist(), trial.picture.d[:, i[0]].tolist()) for i in wrong.values()]
        assert not wrong, f"{name}: {', '.join(f'{i.size} {kind}' for kind, i in wrong.items())}, first {places}"


@pytest.mark.gpu
@pytest.mark.parametrize("batch", BATCHES)
def test_random_scenes(batch: int, tracing: Tracing) -> None:
    @given(text=scenes(), view=st.sampled_from(VIEWS), other=st.sampled_from(OTHERS))
    def law(text: str, view: View, other: str) -> None:
        note(text)
        check(text, view, tracing, ("proven", *OTHERS) if MANY else ("proven", other))

    grown(batch, TRACED, law)


@pytest.mark.gpu
@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_alone_and_cut_by_each(kind: str, tracing: Tracing) -> None:
    """Every shape of the kind by itself, less a bore, and as what is cut away."""
    for shape in KINDS[kind]:
        parts = [f"({shape}).translate([-1, 0, 0])", f"(({shape}) - cylinder(radius: 0.2, height: 3).rotate(x: 70deg))"]
        parts.append(f"(box(size: [1.3, 1.1, 0.9]) - ({shape}).shear(xy: 0.3)).translate([1.2, 0, 0])")
        check(whole(parts), VIEWS[0], tracing)


@pytest.mark.gpu
def test_many_and_cut(tracing: Tracing) -> None:
    """Tables beside other parts, and tables that are cut (and so are no members of the scene's union)."""
    compiled = compiled_text("scene { " + table(64, 1) + " }")
    assert isinstance(compiled.plan.root, Many) or any(isinstance(s, Many) for s in compiled.plan.root.steps)
    assert len(leaves_of(compiled.plan.root)) == 64
    for extra in ("", "torus(major: 0.6, minor: 0.1)", "box(size: [0.5, 0.5, 0.5]) - sphere(radius: 0.3)"):
        check("scene { " + table(64, 1) + " " + extra + " }", VIEWS[0], tracing)
    check("scene { (" + table(60, 2) + ") - box(size: [1, 1, 1]) }", VIEWS[1], tracing)
    check("scene { " + table(60, 2).replace("sphere(radius: ", "box(size: [1, 1.4, 0.6] * ") + " }", VIEWS[1], tracing)


@pytest.mark.parametrize("batch", BATCHES)
def test_what_was_proved_holds_where_it_is_sampled(batch: int) -> None:
    law = given(text=scenes(), dice=st.integers(0, 2**31).map(np.random.default_rng))(holds_where_it_is_sampled)
    grown(batch, SAMPLED, law)


def holds_where_it_is_sampled(text: str, dice: np.random.Generator) -> None:
    """The normal form is the scene; a part is in its box, no steeper than it may be, convex where it is said to be."""
    try:
        compiled = compiled_text(text)
    except SceneError as error:
        assert "solid everywhere" in str(error)
        return
    note(text)
    assert_same_sign(compiled, dice.uniform(-1.5, 1.5, (3, 300)))
    for leaf, region in _regions(compiled.plan.root, everything()):
        here = region.meet(Box((-1.3,) * 3, (1.3,) * 3))
        if not here.is_empty:
            a, b = (dice.uniform(np.array(here.lo)[:, None], np.array(here.hi)[:, None], (3, 200)) for _ in range(2))
            assert_facts(compiled, leaf, a, b)


def assert_same_sign(compiled: Compiled, p: Array) -> None:
    """The scene before and after all passes, at every point p (3, n) that is not at its surface."""
    scene, frame = compiled.scene, compiled.frame
    own = (p - np.array(frame.centre)[:, None]) / frame.radius
    at = scene.values.input("p")
    as_written, normal = (  # of an empty scene it is one number
        np.broadcast_to(Evaluator([lower(shape, at)])({"p": points}, {})[0], p.shape[1:])
        for shape, points in ((scene.root, p), (compiled.shape, own))
    )
    clear = np.minimum(np.abs(as_written), np.abs(normal)) > 1e-9
    np.testing.assert_array_equal((as_written < 0)[clear], (normal < 0)[clear])


def assert_facts(compiled: Compiled, leaf: Leaf, a: Array, b: Array) -> None:
    """What the leaf's step rests on, between pairs of points (3, n) of where it holds."""
    part = leaf.part
    f_a, f_b, f_half = (_values(compiled, part, p) for p in (a, b, 0.5 * (a + b)))
    assert not (_is_outside(part, a) & (f_a < 0.0)).any(), f"{part.name} reaches out of its box"
    match leaf:
        case Ball() | Blend():
            steep = np.abs(f_a - f_b) - leaf.lipschitz * np.linalg.norm(a - b, axis=0)
            # what is cut away is stepped out of from within: its constant is asked for in its box alone
            steep = steep[~(_is_outside(part, a) | _is_outside(part, b))] if _is_cut_away(leaf) else steep
            assert steep.max(initial=0.0) < 1e-9, f"{part.name} is steeper than {leaf.lipschitz}"
        case Tangent() | Chord():
            assert (f_half - 0.5 * (f_a + f_b)).max() < 1e-9, f"{part.name} is not convex"
        case Closed():
            pass  # its rays are held against its field by tests/std/test_rays.py


def _regions(step: Step, region: Box) -> list[tuple[Leaf, Box]]:
    """Every leaf, with the box in which its facts hold."""
    match step:
        case Any() | All():
            return [found for s in step.steps for found in _regions(s, region)]
        case Within():
            return _regions(step.step, region.meet(step.box) if step.is_needed else region)
        case Many():
            return [(member, region) for member in step.members]
        case _:
            return [(step, region)]


def _is_outside(part: Part, p: Array) -> NDArray[np.bool_]:
    lo, hi = (np.array(end)[:, None] for end in (part.box.lo, part.box.hi))
    outside: NDArray[np.bool_] = ((p < lo - 1e-6) | (p > hi + 1e-6)).any(axis=0)
    return outside


def _is_cut_away(leaf: Leaf) -> bool:
    match leaf:
        case Ball(inside=inside):
            return not inside
        case _:
            return False


def _values(compiled: Compiled, part: Part, p: Array) -> Array:
    """The part's field in the scene, (n,)."""
    at = compiled.scene.values.input("p")
    (values,) = Evaluator([part.stretch * lower(part.shape, own_point(part.inverse, at))])({"p": p}, {})
    return np.broadcast_to(values, p.shape[1:])
