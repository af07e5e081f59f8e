"""Law: two proofs that share nothing but the rays agree; what is kept is what was proved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_trees import CLOSED, TWO_INTERVALS
from truth import Picture, compiled_text, random_rays, truth_of, unanswered

from sdfc.diagnostics import InternalError
from sdfc.measure import truth as module
from sdfc.measure.truth import Proof, Truth
from sdfc.reference.certify import Certificate, Status

CONE = (0.0, 5e-3)  # half a pixel of a picture a hundred pixels high
CUT = "scene { box(size: [1.2, 1, 0.9]) - sphere(radius: 0.5) - cylinder(radius: 0.2, height: 3) }"
NUMBERS = st.integers(-6, 6).map(lambda n: n / 10)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SDFC_CACHE_DIR", str(tmp_path))
    return tmp_path


@st.composite
def hard_trees(draw: st.DrawFn, depth: int = 2) -> str:
    """Closed-form leaves, placed, in hard operations."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        leaf = draw(st.sampled_from(CLOSED + TWO_INTERVALS))
        turn = draw(st.sampled_from(["", ".rotate(x: 30deg)", ".rotate(y: 77deg).scale([1, 0.8, 1.2])"]))
        return f"({leaf}){turn}.translate([{draw(NUMBERS)}, {draw(NUMBERS)}, {draw(NUMBERS)}])"
    a, b = draw(hard_trees(depth - 1)), draw(hard_trees(depth - 1))
    return f"(({a}) {draw(st.sampled_from(['|', '&', '-', '-']))} ({b}))"


def rays(count: int = 300, seed: int = 1) -> Picture:
    return unanswered(*random_rays(count, seed))


def same(a: Truth, b: Truth) -> bool:
    arrays = [(getattr(a.certificate, name), getattr(b.certificate, name)) for name in Certificate.__slots__]
    arrays += [(a.proof, b.proof), (a.normal, b.normal), (a.crease, b.crease)]
    return a.tolerance == b.tolerance and all(x.tobytes() == y.tobytes() for x, y in arrays)


@settings(max_examples=30)
@given(tree=hard_trees(), seed=st.integers(0, 2**31))
def test_both_proofs_agree_on_random_hard_csg(tree: str, seed: int) -> None:
    """`truth_of` raises where they do not."""
    compiled = compiled_text(f"scene {{ {tree} }}")
    truth = truth_of(compiled, rays(200, seed), CONE, cache=False)
    assert (truth.proof == Proof.BOTH).all()
    assert truth.sure.mean() > 0.7
    np.testing.assert_array_equal(np.isfinite(truth.t), truth.hit)


def test_a_pass_that_changes_the_solid_is_found_and_the_ray_named() -> None:
    compiled = compiled_text(CUT)
    *kept, _ = compiled.shape.children
    wrong = replace(compiled, shape=compiled.scene.shapes.intersection(kept, compiled.shape.span))
    with pytest.raises(InternalError, match=r"disagree about \d+ of 300 rays, first about ray \d+, from \[.*closed"):
        truth_of(wrong, rays(), CONE, cache=False)


def test_a_sample_is_proved_where_all_is_too_dear(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = compiled_text(CUT)
    every = truth_of(compiled, rays(), CONE, cache=False)
    monkeypatch.setattr(module, "AFFORDABLE", 1)
    some = truth_of(compiled, rays(), CONE, cache=False)
    assert (every.proof == Proof.BOTH).all()
    assert (some.proof == Proof.BOTH).sum() == module.LEAST_SAMPLE and (some.proof != 0).all()
    by_events = some.proof == Proof.EVENTS
    sure = some.sure & every.sure
    assert (sure & by_events).sum() > 150
    np.testing.assert_array_equal(some.hit[sure], every.hit[sure])
    hit = sure & every.hit
    np.testing.assert_allclose(some.t[hit], every.t[hit], atol=1e-9)
    assert (np.abs(some.normal - every.normal)[:, hit & ~some.crease & ~every.crease] < 1e-6).all()


def test_a_field_without_closed_rays_is_proved_by_intervals_alone() -> None:
    compiled = compiled_text("scene { union(blend: 0.2) { sphere(radius: 0.5) box(size: [0.4, 1.4, 0.4]) } }")
    assert (truth_of(compiled, rays(), CONE, cache=False).proof == Proof.INTERVALS).all()


def test_contested_is_what_an_error_of_the_tolerance_may_decide() -> None:
    """Rays past a unit ball, from three tolerances inside its rim to three outside."""
    compiled = compiled_text("scene { sphere(radius: 1) }")
    radius = 1.0 / compiled.frame.radius
    near = truth_of(compiled, rays(), CONE, cache=False).tolerance
    off = np.linspace(-3.0, 3.0, 61)
    o = np.stack([radius + near * off, np.zeros(61), np.full(61, -3.0)])
    picture = unanswered(o, np.repeat(np.array([[0.0], [0.0], [1.0]]), 61, axis=1))
    truth = truth_of(compiled, picture, CONE, cache=False)
    clear = np.abs(np.abs(off) - truth.tolerance / near) > 0.15
    np.testing.assert_array_equal(truth.certificate.contested[clear], np.abs(off[clear]) < truth.tolerance / near)
    decided = off != 0.0
    np.testing.assert_array_equal(truth.hit[decided], off[decided] < 0.0)


def test_normals_and_creases_of_a_box() -> None:
    compiled = compiled_text("scene { box(size: [1, 1, 1]) }")  # of half size 1 / sqrt(3) in its own unit
    truth = truth_of(compiled, rays(3000), CONE, cache=False)
    point = rays(3000).o + np.where(truth.hit, truth.t, 0.0) * rays(3000).d
    sizes = np.sort(np.abs(point), axis=0)
    at_edge = sizes[2] - sizes[1] < 1e-5
    smooth = truth.hit & ~truth.crease
    assert smooth.sum() > 800
    assert not (smooth & at_edge).any()
    assert (truth.crease & (sizes[2] - sizes[1] > 2e-3)).sum() == 0
    axis = np.argmax(np.abs(point), axis=0)[smooth]
    normal = truth.normal[:, smooth]
    facing = normal[axis, np.arange(axis.size)] * np.sign(point[:, smooth][axis, np.arange(axis.size)])
    np.testing.assert_allclose(facing, 1.0, atol=1e-9)


def test_what_was_proved_is_kept() -> None:
    compiled = compiled_text(CUT)
    first = truth_of(compiled, rays(), CONE)
    second = truth_of(compiled_text(CUT), rays(), CONE)
    assert not first.from_cache and second.from_cache and same(first, second)


@pytest.mark.parametrize("what", ["a ray", "the cone", "the scene", "a param", "the order of the cuts"])
def test_another_question_has_another_answer(what: str) -> None:
    text = "param hole = 0.2 in 0.1..0.4\n" + CUT.replace("radius: 0.2", "radius: hole")
    compiled, picture = compiled_text(text), rays()
    assert not truth_of(compiled, picture, CONE).from_cache
    match what:
        case "a ray":
            moved = picture.o.copy()
            moved[0, 7] = np.nextafter(moved[0, 7], 9.0)
            other = truth_of(compiled, replace(picture, o=moved), CONE)
        case "the cone":
            other = truth_of(compiled, picture, (0.0, 6e-3))
        case "the scene":
            other = truth_of(compiled_text(text.replace("0.9]", "0.8]")), picture, CONE)
        case "a param":
            other = truth_of(compiled, picture, CONE, params={"hole": (0.3,)})
        case _:
            parts = text.split(" - ")
            other = truth_of(compiled_text(f"{parts[0]} - {parts[2].rstrip(' }')} - {parts[1]} }}"), picture, CONE)
    assert not other.from_cache
    assert truth_of(compiled, picture, CONE).from_cache


def test_without_a_cache_nothing_is_read_or_written(folder: Path) -> None:
    compiled = compiled_text(CUT)
    truth_of(compiled, rays(), CONE, cache=False)
    assert list(folder.iterdir()) == []


def test_a_file_that_holds_something_else_is_proved_anew(folder: Path) -> None:
    compiled = compiled_text(CUT)
    first = truth_of(compiled, rays(), CONE)
    (file,) = folder.rglob("*.npz")
    for other in ({"t": np.zeros(3)}, {"proof": np.zeros((2, 2))}):
        np.savez_compressed(file, **other)
        again = truth_of(compiled, rays(), CONE)
        assert not again.from_cache and same(first, again)


def test_live_values_move_the_truth() -> None:
    compiled = compiled_text("param size = 0.5 in 0.2..0.8\nscene { sphere(radius: size) box(size: [3, 3, 0.1]) }")
    small, large = (truth_of(compiled, rays(), CONE, params={"size": (size,)}, cache=False) for size in (0.3, 0.8))
    assert large.t[large.hit & small.hit].mean() < small.t[large.hit & small.hit].mean() - 0.01


def test_progress_goes_from_little_to_all() -> None:
    shares: list[float] = []
    truth_of(compiled_text(CUT), rays(), CONE, progress=shares.append, cache=False)
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) > 2


def test_rays_along_a_face_are_ambiguous() -> None:
    """Within a rounding of the plane of a face nobody can say; a million roundings away both sides are known."""
    compiled = compiled_text("scene { box(size: [2, 2, 2]) }")
    roundings = np.concatenate([np.arange(-8.0, 9.0), [-1e6, 1e6]])
    face = 1.0 / compiled.frame.radius + roundings * 2.0**-53
    o = np.stack([np.full(19, -3.0), face, np.zeros(19)])
    picture = unanswered(o, np.repeat(np.array([[1.0], [0.0], [0.0]]), 19, axis=1))
    truth = truth_of(compiled, picture, CONE, cache=False)
    ambiguous = truth.certificate.status == Status.AMBIGUOUS
    assert ambiguous.any() and not ambiguous[-2:].any()
    assert not (ambiguous & (truth.hit | truth.sure)).any()
    assert truth.hit[-2] and not truth.hit[-1]
    assert not truth.sure.any()  # a millionth of a tolerance from a face
