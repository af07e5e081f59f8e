"""Merging ray intervals: small cases by hand, random trees against membership of sample points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.reference.events import Both, Either, FirstRun, Leaf, Solid, Without, first_runs


def leaf(*intervals: tuple[float, float]) -> Leaf:
    return Leaf(*np.array(intervals, float).T[:, :, None])


def first(solid: Solid, start: float = 0.0, end: float = 100.0, thin: float = 0.0) -> tuple[bool, float, float]:
    run = first_runs(solid, start, end, thin)
    return bool(run.hit[0]), float(run.t[0]), float(run.thickness[0])


def test_one_leaf() -> None:
    assert first(leaf((2.0, 5.0))) == (True, 2.0, 3.0)
    assert first(leaf((5.0, 2.0))) == (False, np.inf, 0.0)
    assert first(leaf((np.nan, np.nan))) == (False, np.inf, 0.0)
    assert first(leaf((7.0, 8.0), (2.0, 3.0))) == (True, 2.0, 1.0)
    assert first(leaf((-5.0, -2.0))) == (False, np.inf, 0.0)
    assert first(leaf((-5.0, 2.0))) == (True, 0.0, 2.0)
    assert first(leaf((2.0, 5.0)), end=1.0) == (False, np.inf, 0.0)
    assert first(leaf((-np.inf, np.inf))) == (True, 0.0, np.inf)


def test_operators() -> None:
    a, b = leaf((1.0, 4.0)), leaf((3.0, 6.0))
    assert first(Either((a, b))) == (True, 1.0, 5.0)
    assert first(Both((a, b))) == (True, 3.0, 1.0)
    assert first(Without(a, b)) == (True, 1.0, 2.0)
    assert first(Without(b, a)) == (True, 4.0, 2.0)
    assert first(Without(a, a))[0] is False
    assert first(Without(a, Without(a, b))) == (True, 3.0, 1.0)
    assert first(Both((a, b, leaf((3.5, 9.0))))) == (True, 3.5, 0.5)


def test_touching_solids_are_one_run_and_touching_is_not_overlapping() -> None:
    a, b = leaf((1.0, 2.0)), leaf((2.0, 3.0))
    assert first(Either((a, b))) == (True, 1.0, 2.0)
    assert first(Both((a, b)))[0] is False


def test_thin_runs_are_dropped_after_thin_gaps_are_closed() -> None:
    solid = Either((leaf((1.0, 1.001)), leaf((2.0, 2.006)), leaf((2.007, 2.02)), leaf((5.0, 6.0))))
    run = first_runs(solid, 0.0, 100.0, thin=0.01)
    assert run.t[0] == 2.0 and run.thickness[0] == pytest.approx(0.02) and run.films[0] == 1
    assert run.gap[0] == pytest.approx(0.999)
    assert first_runs(solid, 0.0, 100.0).t[0] == 1.0
    assert first_runs(solid, 0.0, 1.5, thin=0.01).films[0] == 1


def test_a_shared_node_and_a_deep_tree() -> None:
    solid: Solid = leaf((1.0, 2.0))
    for i in range(3000):
        solid = Without(Either((solid, solid)), leaf((1.0, 1.0 + i / 6000.0)))
    hit, t, thickness = first(solid)
    assert hit and t == pytest.approx(1.0 + 2999 / 6000.0) and t + thickness == 2.0


@st.composite
def trees(draw: st.DrawFn, depth: int = 3) -> Solid:
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        ends = draw(st.lists(st.integers(0, 40), min_size=2, max_size=6, unique=True))
        ends = sorted(ends)[: len(ends) // 2 * 2]
        return leaf(*((float(a), float(b)) for a, b in zip(ends[::2], ends[1::2], strict=True)))
    parts = tuple(draw(trees(depth - 1)) for _ in range(draw(st.integers(2, 3))))
    return draw(st.sampled_from([Either(parts), Both(parts), Without(parts[0], parts[1])]))


def inside(solid: Solid, t: np.ndarray) -> np.ndarray:
    match solid:
        case Leaf(enter, exit_):
            return ((enter <= t) & (t <= exit_)).any(axis=0)
        case Either(parts):
            return np.any([inside(part, t) for part in parts], axis=0)
        case Both(parts):
            return np.all([inside(part, t) for part in parts], axis=0)
        case Without(kept, removed):
            return inside(kept, t) & ~inside(removed, t)


@settings(max_examples=300, deadline=None)
@given(trees(), st.integers(-1, 20))
def test_random_trees_agree_with_membership(solid: Solid, start: int) -> None:
    """Between integers nothing changes, so the cells' middles decide everything."""
    middles = np.arange(start, 45) + 0.5
    solid_cells = np.flatnonzero(inside(solid, middles))
    run: FirstRun = first_runs(solid, float(start), 44.0)
    assert run.hit[0] == bool(solid_cells.size)
    if solid_cells.size:
        assert run.t[0] == middles[solid_cells[0]] - 0.5
        behind = np.flatnonzero(~inside(solid, middles[solid_cells[0] :]))
        assert run.thickness[0] == behind[0]


def test_rays_are_independent() -> None:
    enter, exit_ = np.array([[1.0, 5.0, np.nan], [7.0, 1.0, 3.0]]), np.array([[2.0, 6.0, 1.0], [8.0, 2.0, 4.0]])
    run = first_runs(Leaf(enter, exit_), np.zeros(3), np.array([10.0, 10.0, 2.0]))
    assert run.t.tolist() == [1.0, 1.0, np.inf] and run.gap.tolist() == [5.0, 3.0, np.inf]
