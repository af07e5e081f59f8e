"""What a class says of the distance is so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import SOLIDS, SPAN, Array, Menu, World, checked, points_around, profiles, seeds, solids, some_params

from sdfc.facts.exactness import exactness
from sdfc.field.derivative import gradient
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Shape
from sdfc.shape.lower import lower
from sdfc.shape.matrix import scaling

OUTSIDE = (Exactness.EXACT, Exactness.EXACT_OUTSIDE)
INSIDE = (Exactness.EXACT, Exactness.EXACT_INSIDE)


def surface_points(world: World, shape: Shape, params: dict[str, Any], generator: np.random.Generator) -> Array:
    """Where random segments cross the surface."""
    evaluator = Evaluator([lower(shape, world.values.input("p", Type(shape.dimension)))])
    points = points_around(generator, 1000, shape.dimension)
    value = np.broadcast_to(evaluator({"p": points}, params)[0], points.shape[1:])
    inside, outside = points[:, value < 0], points[:, value > 0]
    if inside.shape[1] == 0 or outside.shape[1] == 0:
        return points[:, :0]
    a = inside[:, generator.integers(0, inside.shape[1], 500)]
    b = outside[:, generator.integers(0, outside.shape[1], 500)]
    for _ in range(45):
        middle = (a + b) / 2
        within = evaluator({"p": middle}, params)[0] < 0
        a, b = np.where(within, middle, a), np.where(within, b, middle)
    return (a + b) / 2


def check_bound(world: World, shape: Shape, params: dict[str, Any], generator: np.random.Generator) -> None:
    surface = surface_points(world, shape, params, generator)
    if surface.shape[1] == 0:
        return
    points = points_around(generator, 100, shape.dimension)
    distance = np.linalg.norm(points[:, :, None] - surface[:, None, :], axis=0).min(axis=1)
    excess = np.abs(world.value(shape, points, params)) - distance - 1e-7
    assert excess.max() <= 0, points[:, np.argmax(excess)]


def check_exact(
    world: World, shape: Shape, params: dict[str, Any], generator: np.random.Generator, is_outside: bool
) -> None:
    """From a point, the distance along the gradient is the surface."""
    p = world.values.input("p", Type(shape.dimension))
    root = lower(shape, p)
    evaluator = Evaluator([root, gradient(root, p)])
    points = points_around(generator, 400, shape.dimension)
    value, slope = evaluator({"p": points}, params)
    value, slope = np.broadcast_to(value, points.shape[1:]), np.broadcast_to(slope, points.shape)
    chosen = (value > 1e-6) if is_outside else (value < -1e-6)
    foot = points[:, chosen] - value[chosen] * slope[:, chosen]
    left = np.abs(world.value(shape, foot, params))
    assert (left <= 1e-6).mean() > 0.99 if chosen.any() else True, points[:, chosen][:, np.argmax(left)]


def check_class(world: World, shape: Shape, seed: int) -> Exactness:
    found = exactness(shape)[shape.id]
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    if found is not Exactness.NONE:
        check_bound(world, shape, params, generator)
    if found in OUTSIDE:
        check_exact(world, shape, params, generator, True)
    if found in INSIDE:
        check_exact(world, shape, params, generator, False)
    return found


@checked
@given(data=st.data(), seed=seeds)
def test_any_solid(data: st.DataObject, seed: int) -> None:
    world = World()
    check_class(world, data.draw(solids(world, Menu(nothing=False))), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_solids_that_are_often_exact(data: st.DataObject, seed: int) -> None:
    world = World()
    exact = {name: drawn for name, drawn in SOLIDS.items() if name not in ("gyroid", "ellipsoid")}
    menu = Menu(
        exact, {"round": ("radius",)}, {}, {"extrude": ("height",)}, ("translate", "rotate", "scale"), nothing=False
    )
    check_class(world, data.draw(solids(world, menu)), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_profiles(data: st.DataObject, seed: int) -> None:
    world = World()
    check_class(world, data.draw(profiles(world)), seed)


@pytest.mark.parametrize(
    ("build", "wanted"),
    [
        (lambda w, a, b: a, Exactness.EXACT),
        (lambda w, a, b: w.shapes.union([a, b], SPAN), Exactness.EXACT_OUTSIDE),
        (lambda w, a, b: w.shapes.intersection([a, b], SPAN), Exactness.EXACT_INSIDE),
        (lambda w, a, b: w.shapes.complement(w.shapes.union([a, b], SPAN), SPAN), Exactness.EXACT_INSIDE),
        (lambda w, a, b: w.shapes.difference(a, [b], SPAN), Exactness.EXACT_INSIDE),
        (lambda w, a, b: w.apply("round", w.shapes.union([a, b], SPAN)), Exactness.EXACT_OUTSIDE),
        (lambda w, a, b: w.apply("round", w.shapes.intersection([a, b], SPAN)), Exactness.BOUND),
        (lambda w, a, b: w.moved(scaling(w.values, 1, 2, 1), a), Exactness.BOUND),
        (lambda w, a, b: w.apply("displace", a), Exactness.NONE),
        (lambda w, a, b: w.shapes.union([a, w.apply("quadric")], SPAN), Exactness.NONE),
    ],
)
def test_the_lattice(build: Any, wanted: Exactness) -> None:
    world = World()
    a, b = world.apply("sphere"), world.at(0.4, 0.1, 0.0, world.apply("box"))
    assert check_class(world, build(world, a, b), 7) is wanted
