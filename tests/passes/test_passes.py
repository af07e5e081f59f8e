"""Every pass keeps the solid, its spans and its materials, and what it promises holds afterwards."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import (
    SOLIDS,
    SPAN,
    USER_SOLIDS,
    Menu,
    World,
    checked,
    points_around,
    profiles,
    seeds,
    solids,
    some_params,
)

from sdfc.passes.bare import bare
from sdfc.passes.flatten import flatten
from sdfc.passes.negate import negate
from sdfc.passes.own_origin import frame_of, own_origin
from sdfc.passes.paint import paint
from sdfc.passes.place import place
from sdfc.passes.promises import PROMISES, pruned
from sdfc.passes.prune import prune
from sdfc.passes.recognise import recognise
from sdfc.shape.graph import Shape, topological
from sdfc.shape.verify import verify

RUN: dict[str, Callable[[Shape, World], Shape]] = {
    "recognise": lambda s, w: recognise(s, w.shapes, w.values, w.library.definition),
    "flatten": lambda s, w: flatten(s, w.shapes),
    "paint": lambda s, w: paint(s, w.shapes),
    "place": lambda s, w: place(s, w.shapes, w.values),
    "negate": lambda s, w: negate(s, w.shapes, w.library.definition),
    "bare": lambda s, w: bare(s, w.shapes, w.values),
    "prune": lambda s, w: prune(s, w.shapes, w.bounds),
}
MENU = Menu(solids=SOLIDS | USER_SOLIDS, materials=True)


def check_same_solid(world: World, before: Shape, after: Shape, seed: int) -> None:
    generator = np.random.default_rng(seed)
    for _ in range(2):
        params = some_params(generator)
        points = points_around(generator, 1500)
        was, now = world.value(before, points, params), world.value(after, points, params)
        changed = ((was < 0) != (now < 0)) & (np.abs(was) > 1e-7)
        assert not changed.any(), (points[:, changed][:, 0], was[changed][0], now[changed][0])


@pytest.mark.parametrize("name", RUN)
@checked
@given(data=st.data(), seed=seeds)
def test_the_solid_stays(name: str, data: st.DataObject, seed: int) -> None:
    world = World()
    shape = data.draw(solids(world, MENU))
    after = RUN[name](shape, world)
    verify(after)
    check_same_solid(world, shape, after, seed)


@pytest.mark.parametrize("name", PROMISES)
@checked
@given(data=st.data())
def test_what_is_promised_holds(name: str, data: st.DataObject) -> None:
    world = World()
    after = RUN[name](data.draw(solids(world, MENU)), world)
    assert list(PROMISES[name](after)) == []


@checked
@given(data=st.data(), seed=seeds)
def test_extrusions_stay(data: st.DataObject, seed: int) -> None:
    """Of all kinds of profiles: alone, moved, and cut by others."""
    world = World()
    shape = data.draw(solids(world, Menu(solids={"sphere": ()}, one_child={}, two_children={}), 2))
    lift = data.draw(st.sampled_from(["extrude", "revolve"]))
    whole = world.shapes.union([shape, world.apply(lift, data.draw(profiles(world)))], SPAN)
    after = RUN["recognise"](whole, world)
    verify(after)
    check_same_solid(world, whole, after, seed)


@checked
@given(data=st.data())
def test_nothing_is_left_to_prune(data: st.DataObject) -> None:
    world = World()
    after = data.draw(solids(world, MENU))
    for name in ("place", "negate", "flatten", "prune"):
        after = RUN[name](after, world)
    assert list(pruned(after, world.bounds)) == []


@pytest.mark.parametrize("name", RUN)
@checked
@given(data=st.data())
def test_twice_is_once(name: str, data: st.DataObject) -> None:
    world = World()
    once = RUN[name](data.draw(solids(world, MENU)), world)
    assert RUN[name](once, world) is once


@checked
@given(data=st.data(), seed=seeds)
def test_all_passes_after_each_other(data: st.DataObject, seed: int) -> None:
    """As the pipeline runs them, its promises kept to the end."""
    world = World()
    shape = data.draw(solids(world, MENU))
    after = shape
    for name in ("recognise", "flatten", "paint", "place", "negate", "bare", "prune", "place", "flatten"):
        after = RUN[name](after, world)
    check_same_solid(world, shape, after, seed)
    for name, promise in PROMISES.items():
        assert list(promise(after)) == [], name


@checked
@given(data=st.data(), seed=seeds)
def test_fields_are_the_same_where_maps_are_similarities(data: st.DataObject, seed: int) -> None:
    world = World()
    shape = data.draw(solids(world, Menu(maps=("translate", "rotate", "scale", "mirror"), live=False, nothing=False)))
    after = place(shape, world.shapes, world.values)
    points = points_around(np.random.default_rng(seed), 500)
    assert np.allclose(world.value(shape, points, {}), world.value(after, points, {}), rtol=1e-9, atol=1e-9)


@checked
@given(data=st.data(), seed=seeds)
def test_the_own_frame_holds_the_scene(data: st.DataObject, seed: int) -> None:
    world = World()
    shape = data.draw(solids(world, MENU))
    frame = frame_of(shape, world.bounds)
    after = own_origin(shape, world.shapes, world.values, frame)
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    points = points_around(generator, 1500)
    own = (points - np.array(frame.centre)[:, None]) / frame.radius
    was, now = world.value(shape, points, params), world.value(after, own, params)
    assert np.allclose(was, now * frame.radius, rtol=1e-9, atol=1e-9)
    if frame.is_finite:
        assert np.linalg.norm(own[:, was <= 0], axis=0).max(initial=0.0) <= 1 + 1e-9


@pytest.mark.parametrize("name", RUN)
@checked
@given(data=st.data())
def test_every_node_has_a_place_in_the_source(name: str, data: st.DataObject) -> None:
    world = World()
    after = RUN[name](data.draw(solids(world, MENU)), world)
    assert all(node.span is SPAN for node in topological(after))


def test_a_scene_that_is_too_small_for_float64_is_refused() -> None:
    from sdfc.diagnostics import SceneError, Source
    from sdfc.pipeline import compile_scene, load

    with pytest.raises(SceneError, match="less than 1e-100 across"):
        compile_scene(load(Source("test.sdf", "scene { sphere(1e-320) }")))


@checked
@given(data=st.data())
def test_what_is_placed_stays_so(data: st.DataObject) -> None:
    """Until something is pruned: that it need not be placed again is what the pipeline goes by."""
    world = World()
    after = data.draw(solids(world, MENU))
    for name in ("recognise", "flatten", "paint", "place", "negate", "bare"):
        after = RUN[name](after, world)
    assert RUN["place"](after, world) is after
