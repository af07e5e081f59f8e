"""Derivatives against central differences, and one-sided differences at kinks."""

from __future__ import annotations

import numpy as np
import pytest
from field_trees import PARAM_VALUES, Recipe, points, trees
from hypothesis import given, settings

from sdfc.field.derivative import directional, gradient, has_rule
from sdfc.field.graph import Expr, FieldGraph, Op, Type, topological
from sdfc.field.numeric import Evaluator

STEP = 1e-5


def value(root: Expr, inputs: dict[str, np.ndarray]) -> np.ndarray:
    (result,) = Evaluator([root])(inputs, PARAM_VALUES)
    return result


def moved(inputs: dict[str, np.ndarray], name: str, by: np.ndarray) -> dict[str, np.ndarray]:
    return {**inputs, name: inputs[name] + by}


@pytest.mark.parametrize("op", list(Op))
def test_every_operation_has_rules(op: Op) -> None:
    assert has_rule(op)


@settings(max_examples=120, deadline=None)
@given(trees(smooth=True))
def test_smooth_expressions_against_central_differences(recipe: Recipe) -> None:
    graph = FieldGraph()
    root, p = recipe.build(graph), graph.input("p")
    inputs = points(30)
    slopes = np.broadcast_to(value(gradient(root, p), inputs), (3, 30))
    for axis in range(3):
        step = STEP * np.eye(3)[:, axis : axis + 1]
        ahead, here, behind = (value(root, moved(inputs, "p", k * step)) for k in (1, 0, -1))
        expected = np.broadcast_to((ahead - behind) / (2 * STEP), (30,))
        # the error of the difference: curvature, judged by the second difference, and rounding
        doubled = value(root, moved(inputs, "p", 2 * step)) - value(root, moved(inputs, "p", -2 * step))
        doubt = np.abs(doubled / (4 * STEP) - expected) + 1e-10 / STEP * np.maximum(1.0, np.abs(here)) * 0.1
        assert np.all(np.abs(slopes[axis] - expected) <= 1e-5 * (1 + np.abs(expected)) + 3 * doubt)


@settings(max_examples=120, deadline=None)
@given(trees())
def test_forward_and_reverse_mode_agree(recipe: Recipe) -> None:
    graph = FieldGraph()
    root, p = recipe.build(graph), graph.input("p")
    direction = graph.constant(0.3, -0.7, 0.2)
    inputs = points(30)
    along = value(directional(root, {p: direction}), inputs)
    expected = np.sum(np.array(direction.numbers)[:, None] * value(gradient(root, p), inputs), axis=0)
    assert np.allclose(along, expected, rtol=1e-6, atol=1e-6 * (1 + np.max(np.abs(expected), initial=0.0)))


@settings(max_examples=60, deadline=None)
@given(trees(Type.VEC3, smooth=True))
def test_forward_mode_of_vectors(recipe: Recipe) -> None:
    graph = FieldGraph()
    root, t = recipe.build(graph), graph.input("t", Type.FLOAT)
    tangent = directional(root, {t: graph.constant(2.0)})
    assert tangent.type is Type.VEC3
    inputs = points(20)
    ahead, behind = (value(root, moved(inputs, "t", np.array(k * STEP))) for k in (1, -1))
    expected = (ahead - behind) / STEP
    scale = 1 + np.max(np.abs(expected), initial=0.0) + np.max(np.abs(ahead), initial=0.0)
    assert np.allclose(value(tangent, inputs), expected, rtol=1e-4, atol=1e-5 * scale)


def kinked(graph: FieldGraph, x: Expr) -> list[tuple[Expr, float]]:
    """Expressions in x and places of their kinks."""
    return [
        (graph.abs(x), 0.0),
        (graph.min(x, 2.0 * x), 0.0),
        (graph.max(2.0 * x - 1.0, 1.0 - x), 2.0 / 3.0),
        (graph.select(x < 1.0, x * 3.0, 2.0 + x), 1.0),
        (graph.clamp(x, -1.0, 1.0), -1.0),
        (graph.abs(graph.vector(x, 1.0))[0], 0.0),
        (graph.max(graph.vector(x, 1.0), 0.0)[0], 0.0),
        (graph.dot(graph.min(graph.vector(x, x), graph.vector(-x, 3.0)), graph.constant(1.0, 1.0)), 0.0),
    ]


@pytest.mark.parametrize("index", range(8))
def test_at_a_kink_the_derivative_is_one_sided(index: int) -> None:
    graph = FieldGraph()
    x = graph.input("t", Type.FLOAT)
    root, place = kinked(graph, x)[index]
    at = {"t": np.array([place])}
    here = value(root, at)[0]
    left = (here - value(root, {"t": np.array([place - STEP])})[0]) / STEP
    right = (value(root, {"t": np.array([place + STEP])})[0] - here) / STEP
    for derivative in (gradient(root, x), directional(root, {x: graph.constant(1.0)})):
        (slope,) = np.atleast_1d(value(derivative, at))
        assert min(abs(slope - left), abs(slope - right)) < 1e-4
    assert abs(left - right) > 0.5


def test_the_slope_of_abs_is_never_zero() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.dot(graph.abs(p), graph.constant(1.0, 1.0, 1.0)) + graph.abs(p[0])
    slopes = value(gradient(root, p), {"p": np.array([[0.0, -1.0, 2.0]] * 3)})
    assert slopes.tolist() == [[2.0, -2.0, 2.0], [1.0, -1.0, 1.0], [1.0, -1.0, 1.0]]


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_norms_and_roots_have_a_finite_slope_at_zero(dtype: type) -> None:
    graph = FieldGraph()
    p = graph.input("p")
    roots = [
        graph.length(p),
        graph.sqrt(graph.dot(p, p)),
        graph.length(p.swizzle("xz")) + graph.call(Op.ATAN2, p[0], p[1]),
    ]
    zero = {"p": np.zeros((3, 1))}
    for root in roots:
        (slope,) = Evaluator([gradient(root, p)], dtype)(zero, {})
        assert slope.tolist() == [[0.0]] * 3


@pytest.mark.parametrize("op", [Op.SIGN, Op.FLOOR, Op.ROUND])
def test_steps_have_no_slope(op: Op) -> None:
    graph = FieldGraph()
    p = graph.input("p")
    assert gradient(graph.call(op, p)[0], p) is graph.constant(0.0, 0.0, 0.0)
    assert directional(graph.call(op, p), {p: p}) is graph.constant(0.0, 0.0, 0.0)


def test_the_gradient_of_a_sphere_is_as_short_as_by_hand() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    distance = graph.length(p)
    assert gradient(distance - 1.0, p) is p / graph.max(distance, 1e-30)


def test_reverse_mode_is_linear_in_size() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.length(p)
    for i in range(2000):
        root = graph.min(root, graph.length(p - graph.constant(i, 1.0, 2.0)) - 0.5)
    size = sum(1 for _ in topological([root]))
    assert sum(1 for _ in topological([gradient(root, p)])) < 4 * size


def test_what_does_not_depend_on_the_point_has_no_gradient() -> None:
    graph = FieldGraph()
    p, t = graph.input("p"), graph.input("t", Type.FLOAT)
    assert gradient(graph.call(Op.SIN, t), p) is graph.constant(0.0, 0.0, 0.0)
    assert directional(t * p, {graph.input("u"): p}) is graph.constant(0.0, 0.0, 0.0)
