"""What is called convex lies below its chords."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import SPAN, Menu, World, checked, points_around, profiles, seeds, solids, some_params

from sdfc.facts.curvature import convex_shapes, is_convex_solid
from sdfc.shape.graph import Shape, topological


def check_convex(world: World, shape: Shape, seed: int) -> None:
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    a, b = (points_around(generator, 1500, shape.dimension) for _ in range(2))
    share = generator.uniform(0, 1, a.shape[1])
    between = world.value(shape, share * a + (1 - share) * b, params)
    chord = share * world.value(shape, a, params) + (1 - share) * world.value(shape, b, params)
    worst = int(np.argmax(between - chord))
    assert between[worst] <= chord[worst] + 1e-9, (a[:, worst], b[:, worst])


def check_convex_solid(world: World, shape: Shape, seed: int) -> None:
    """Whatever is between two points of the solid is in it."""
    if not is_convex_solid(shape):
        return
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    points = points_around(generator, 3000, shape.dimension)
    inside = points[:, world.value(shape, points, params) < 0.0]
    if inside.shape[1] > 1:
        a, b = inside, inside[:, generator.permutation(inside.shape[1])]
        share = generator.uniform(0, 1, a.shape[1])
        assert (world.value(shape, share * a + (1 - share) * b, params) <= 1e-9).all()


def check_all(world: World, root: Shape, seed: int) -> None:
    convex = convex_shapes(root)
    for shape in topological(root):
        if shape.id in convex:
            check_convex(world, shape, seed)
    check_convex_solid(world, root, seed)


@checked
@given(data=st.data(), seed=seeds)
def test_solids(data: st.DataObject, seed: int) -> None:
    world = World()
    check_all(world, data.draw(solids(world)), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_solids_that_are_often_convex(data: st.DataObject, seed: int) -> None:
    world = World()
    kept = {"round": ("radius",), "offset": ("distance",), "bounded": ()}
    blends = {"smooth_intersection": ("blend",), "smooth_intersection_cubic": ("blend",), "morph": ("amount",)}
    menu = Menu(one_child=kept, two_children=blends, sets=("intersection",))
    check_all(world, data.draw(solids(world, menu)), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_profiles(data: st.DataObject, seed: int) -> None:
    world = World()
    check_all(world, data.draw(profiles(world)), seed)


def test_which_solids_are_convex() -> None:
    """A gauge's solid is, but not all that is made of it; one leaf that is not spoils an intersection."""
    world = World()
    egg, ball, ring = world.apply("ellipsoid"), world.apply("sphere"), world.apply("torus")
    meet = world.shapes.intersection([egg, world.at(0.2, 0, 0, ball)], SPAN)
    for shape in (egg, meet, world.at(0.1, 0, 0, meet), world.shapes.union([meet], SPAN)):
        assert is_convex_solid(shape)
    for shape in (ring, world.apply("round", egg), world.shapes.intersection([egg, ring], SPAN)):
        assert not is_convex_solid(shape)
    assert not is_convex_solid(world.shapes.union([egg, ball], SPAN))


def test_which_are_convex() -> None:
    world = World()
    ball, box, ring = world.apply("sphere"), world.at(0.2, 0, 0, world.apply("box")), world.apply("torus")
    meet = world.shapes.intersection([ball, box], SPAN)
    smooth = world.apply("smooth_intersection", ball, world.apply("round", box))
    flat = world.apply("extrude", world.apply("circle"))
    for shape in (ball, box, meet, smooth, flat, world.shapes.union([meet], SPAN)):
        assert shape.id in convex_shapes(shape)
    both = world.shapes.union([ball, box], SPAN)
    for shape in (
        ring,
        both,
        world.shapes.complement(ball, SPAN),
        world.apply("twist", box),
        world.apply("shell", ball),
    ):
        assert shape.id not in convex_shapes(shape)
    assert world.apply("ellipsoid").id not in convex_shapes(world.apply("ellipsoid")), "its gauge is, not its formula"
