"""The stretches of affine maps against the singular values that NumPy finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import ALL_MAPS, SIMILAR, World, checked, maps, plane_map, seeds, some_params

from sdfc.field.graph import Expr, FieldGraph, Op, Type
from sdfc.field.numeric import Evaluator
from sdfc.shape.matrix import Matrix, identity, matrix, rotation, scaling
from sdfc.shape.stretch import is_similarity, largest_stretch, singular_values, smallest_stretch

entries = st.lists(st.floats(-3.0, 3.0), min_size=9, max_size=9)


def numbers(root: Expr, params: dict[str, Any]) -> float:
    return float(Evaluator([root])({}, params)[0])


def rows_of(given: Matrix, params: dict[str, Any], size: int) -> np.ndarray[Any, Any]:
    found = [numbers(e, params) for row in given.linear[:size] for e in row[:size]]
    return np.array(found).reshape(size, size)


def check(given: Matrix, params: dict[str, Any], size: int, factor: float = np.inf) -> None:
    """The bounds hold, and are at most `factor` off."""
    found = np.linalg.svd(rows_of(given, params, size))[1]
    smallest, largest = numbers(smallest_stretch(given, size), params), numbers(largest_stretch(given, size), params)
    assert found[-1] / factor - 1e-9 <= smallest <= found[-1] * (1 + 1e-9) + 1e-12
    assert found[0] * (1 - 1e-9) <= largest <= found[0] * factor + 1e-9
    assert not is_similarity(given, size) or np.ptp(found) <= 1e-9 * found[0]


@checked
@given(values=entries)
def test_constants(values: list[float]) -> None:
    rows = np.array(values).reshape(3, 3)
    given = matrix(FieldGraph(), rows.tolist(), [0, 0, 0])
    check(given, {}, 3, 1 + 2e-9)
    assert np.allclose(singular_values(rows.tolist()), np.linalg.svd(rows)[1][::-1], rtol=1e-9, atol=1e-12)


@checked
@given(exponents=st.lists(st.floats(-7.0, 7.0), min_size=3, max_size=3), data=st.data())
def test_very_different_stretches(exponents: list[float], data: st.DataObject) -> None:
    world = World()
    turned = rotation(world.values, 1, world.values.constant(0.7)).after(
        rotation(world.values, 0, world.values.constant(0.4))
    )
    sizes = [10.0**e for e in exponents]
    given = turned.after(scaling(world.values, *sizes))
    smallest = smallest_stretch(given).number
    assert min(sizes) * (1 - 1e-8) <= smallest <= min(sizes) * (1 + 1e-12)
    assert np.isclose(largest_stretch(given).number, max(sizes), rtol=1e-8)


@checked
@given(data=st.data(), seed=seeds)
def test_live_maps(data: st.DataObject, seed: int) -> None:
    world = World()
    kinds = data.draw(st.sampled_from([SIMILAR, ALL_MAPS]))
    given = data.draw(maps(world, kinds))
    generator = np.random.default_rng(seed)
    for _ in range(3):
        check(given, some_params(generator), 3, 3.0)
    assert kinds is not SIMILAR or is_similarity(given)


@checked
@given(data=st.data(), seed=seeds)
def test_maps_of_the_plane(data: st.DataObject, seed: int) -> None:
    world = World()
    given = plane_map(data.draw, world, True).after(plane_map(data.draw, world, True))
    generator = np.random.default_rng(seed)
    for _ in range(3):
        check(given, some_params(generator), 2, 3.0)


@pytest.mark.parametrize("edge", [0.9, 5.0, 50.0])
def test_what_is_a_similarity_for_some_values_is_none(edge: float) -> None:
    """A branch that only values beyond the samples take."""
    graph = FieldGraph()
    size = graph.param("size")
    for bent in (graph.max(size, edge), graph.abs(size - edge) + edge - size + edge):
        given = scaling(graph, bent, edge, edge)
        assert not is_similarity(given)
        check(given, {"size": 3.0 * edge}, 3, 3.0)


def test_equal_entries_are_a_similarity_whatever_they_are() -> None:
    graph = FieldGraph()
    size = graph.max(graph.param("size"), graph.add(Op.FLOOR, graph.param("turn")) * 0.5)
    assert is_similarity(scaling(graph, size, size, size))
    assert not is_similarity(scaling(graph, size, size, 1.0))
    assert is_similarity(scaling(graph, size, size, 1.0), 2)


def test_a_turn_about_a_live_axis_is_a_similarity() -> None:
    graph = FieldGraph()
    axis = graph.param("axis", Type.VEC3)
    unit = axis / graph.length(axis)
    c, s = graph.add(Op.COS, graph.param("turn")), graph.add(Op.SIN, graph.param("turn"))
    x, y, z = unit[0], unit[1], unit[2]
    cross = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    given = matrix(
        graph,
        [[(c if i == j else 0) + s * cross[i][j] + (1 - c) * unit[i] * unit[j] for j in range(3)] for i in range(3)],
        [0, 0, 0],
    )
    assert is_similarity(given)
    assert smallest_stretch(given).number == 1.0


def test_tiny_and_huge_similarities_keep_their_digits() -> None:
    graph = FieldGraph()
    turn = rotation(graph, 1, graph.param("turn"))
    for size in (1.23456789e-12, 0.1, 1.23456789e15):
        given = turn.after(scaling(graph, size, size, size))
        assert np.isclose(smallest_stretch(given).number, size, rtol=1e-12)
        assert np.isclose(largest_stretch(given).number, size, rtol=1e-12)


def test_a_scale_along_the_axes_is_exact() -> None:
    graph = FieldGraph()
    given = rotation(graph, 0, graph.param("turn")).after(scaling(graph, graph.param("size"), 2.0, 0.5))
    for size in (-3.0, 0.1, 1.0, 7.0):
        check(given, {"turn": 0.3, "size": size}, 3, 1 + 1e-9)


def test_a_flat_map_has_no_smallest_stretch() -> None:
    graph = FieldGraph()
    assert smallest_stretch(scaling(graph, 1.0, 0.0, 1.0)).number == 0.0
    assert not is_similarity(scaling(graph, 0.0, 0.0, 0.0))
    assert smallest_stretch(identity(graph)).number == 1.0
