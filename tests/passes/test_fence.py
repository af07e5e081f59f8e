"""What operations find out of their children: fields that grow however far away, of the same solids."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from shape_trees import Menu, World, checked, points_around, seeds, solids, some_params

from sdfc.passes.fence import fence
from sdfc.shape.graph import Apply, Shape

FENCED = ("twist", "bend", "taper", "repeat")
BOUNDED = Menu(solids={"sphere": ("radius",), "box": ("size",), "ellipsoid": ("radii",)})


def operand_of(world: World, shape: Shape) -> Shape:
    """The shape as it is after the pass, in an operation."""
    after = fence(world.apply("shell", shape), world.shapes, world.bounds)
    assert isinstance(after, Apply) and after.definition.name == "shell"
    return after.children[0]


def made(world: World, name: str, child: Shape) -> Shape:
    if name != "repeat":
        return world.apply(name, child)
    one = world.values.constant(3.0, 1.0, 1.0)
    return world.apply(name, child, spacing=world.values.constant(1.7, 0.0, 1.0), count=one)


@pytest.mark.parametrize("name", FENCED)
@checked
@given(data=st.data(), seed=seeds)
def test_the_same_solid_and_a_field_that_grows(name: str, data: st.DataObject, seed: int) -> None:
    world = World()
    child = data.draw(solids(world, BOUNDED))
    fenced = operand_of(world, made(world, name, child))
    assert isinstance(fenced, Apply)
    shape = made(world, name, fenced.children[0])  # what is in the child has been told of its own children too
    # nothing is found of what is empty; a live map that may be flat has no end at levels above 0
    assume(all(world.bounds.box(child, level).is_finite for level in (0.0, 5.0)))
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    points = np.concatenate([points_around(generator, 1000), 300.0 * points_around(generator, 200)], axis=1)
    was, now = world.value(shape, points, params), world.value(fenced, points, params)
    assert ((was < 0) == (now < 0)).all() and (now >= was).all()
    for level in (0.1, 0.7, 5.0):
        end = world.bounds.box(fenced, level)
        assert end.is_finite
        low, high = np.array(end.lo)[:, None], np.array(end.hi)[:, None]
        assert (now[((points < low) | (points > high)).any(axis=0)] > level).all()


@pytest.mark.parametrize("name", FENCED)
def test_what_stands_alone_is_left_alone(name: str) -> None:
    world = World()
    shape = world.at(1, 0, 0, made(world, name, world.apply("box")))
    assert fence(shape, world.shapes, world.bounds) is shape
    assert operand_of(world, made(world, name, world.apply("box"))) is not shape


@pytest.mark.parametrize("name", ["twist", "bend", "taper"])
def test_what_has_no_end_has_none_afterwards(name: str) -> None:
    world = World()
    half = operand_of(world, made(world, name, world.apply("plane")))
    assert world.bounds.box(half, 0.5).hi[0] == np.inf
