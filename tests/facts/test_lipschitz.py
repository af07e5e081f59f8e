"""No field changes faster than its constant says, over the box that it is for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shape_trees import (
    SPAN,
    USER_SOLIDS,
    Array,
    Menu,
    World,
    checked,
    seeds,
    solids,
    some_params,
)

from sdfc import pipeline
from sdfc.diagnostics import SceneError, Source
from sdfc.facts.box import Box, everything
from sdfc.facts.lipschitz import Lipschitz
from sdfc.shape.graph import Shape
from sdfc.shape.matrix import scaling, translation

LARGE = Box((-2.0,) * 3, (2.0,) * 3)


def lipschitz(world: World) -> Lipschitz:
    return Lipschitz(world.ranges, world.bounds)


def pairs_in(generator: np.random.Generator, box: Box, count: int) -> tuple[Array, Array]:
    """Pairs near each other and far apart, in the box (in what of it is around the origin, where it has no end)."""
    lo, hi = np.clip(box.lo, -4, 4)[:, None], np.clip(box.hi, -4, 4)[:, None]
    a = lo + (hi - lo) * generator.uniform(0, 1, (len(lo), count))
    steps = 10.0 ** generator.uniform(-5, 0, count)
    b = np.clip(a + steps * generator.normal(size=a.shape), lo, hi)
    return a, b


def check_slope(world: World, shape: Shape, domain: Box, seed: int) -> None:
    constant = lipschitz(world).constant(shape, domain)
    region = domain if lipschitz(world).is_global(shape) else domain.meet(world.bounds.box(shape))
    if region.is_empty:
        return
    generator = np.random.default_rng(seed)
    for _ in range(3):
        params = some_params(generator)
        a, b = pairs_in(generator, region, 2000)
        change = np.abs(world.value(shape, a, params) - world.value(shape, b, params))
        excess = change - constant * np.linalg.norm(a - b, axis=0) * (1 + 1e-9) - 1e-9 * max(1.0, constant)
        worst = int(np.argmax(excess))
        assert excess[worst] <= 0, (constant, a[:, worst], b[:, worst], params)


@checked
@given(data=st.data(), seed=seeds)
def test_standard_fields_have_constants_everywhere(data: st.DataObject, seed: int) -> None:
    world = World()
    shape = data.draw(solids(world))
    assert lipschitz(world).is_global(shape)
    check_slope(world, shape, everything(), seed)


@settings(checked, max_examples=max(6, checked.max_examples // 4))  # intervals take their time
@given(data=st.data(), seed=seeds)
def test_fields_without_claims_have_constants_in_their_boxes(data: st.DataObject, seed: int) -> None:
    world = World()
    menu = Menu(solids={"sphere": ("radius",)} | USER_SOLIDS, lifts={}, sets=("union", "difference"), nothing=False)
    shape = data.draw(solids(world, menu, 2))
    try:
        check_slope(world, shape, LARGE, seed)
    except SceneError as error:
        assert "no bound of the slope" in str(error)


def test_a_blend_looks_at_its_operands_far_from_their_boxes() -> None:
    """dot(p, p) is steeper there."""
    world = World()
    far = world.at(3.0, 0.0, 0.0, world.apply("quadric", radius=0.5))
    blend = world.apply("smooth_union", world.apply("quadric", radius=0.5), far, blend=0.3)
    assert lipschitz(world).constant(blend, LARGE) > 4.0
    check_slope(world, blend, LARGE, 3)


def test_a_twist_looks_at_its_child_elsewhere() -> None:
    world = World()
    twisted = world.apply("twist", world.at(0.5, 0.0, 0.0, world.apply("quadric", radius=0.5)), rate=1.0)
    check_slope(world, twisted, LARGE, 4)


def test_the_domain_is_moved_with_a_live_map() -> None:
    world = World()
    size = 0.1 * world.values.param("size")
    there, back = (scaling(world.values, k, k, k) for k in (size, 1.0 / size))
    small = world.shapes.affine(there, back, world.apply("quadric", radius=0.5), SPAN)
    constant = lipschitz(world).throughout(small, LARGE)
    a, b = pairs_in(np.random.default_rng(5), LARGE, 2000)
    change = np.abs(world.value(small, a, {"size": 0.3}) - world.value(small, b, {"size": 0.3}))
    assert (change <= constant * np.linalg.norm(a - b, axis=0) * (1 + 1e-9)).all()
    assert constant > 100
    # a hundredth is a third at the smallest size
    assert lipschitz(world).constant(small, Box((-0.01,) * 3, (0.01,) * 3)) < 2 * math.sqrt(3) * 0.34


def test_a_claim_holds_for_every_value_of_the_params() -> None:
    world = World()
    world.declare("field steep(k: number > 0) = k * (length(p) - 1) lipschitz k bounds -[1, 1, 1] .. [1, 1, 1]")
    shape = world.apply("steep", k=world.values.param("size") * 2)
    assert math.isclose(lipschitz(world).constant(shape, LARGE), 2.8)
    check_slope(world, shape, everything(), 6)


def test_a_claim_may_depend_on_how_large_the_child_is() -> None:
    world = World()
    world.declare(
        "field wide(shape: solid) = shape(p) * 0.5 lipschitz 1 + length(shape.hi) bounds shape.lo .. shape.hi"
    )
    shape = world.apply("wide", world.apply("box"))
    assert math.isclose(lipschitz(world).constant(shape, LARGE), 1 + math.sqrt(0.75))


def test_a_stretched_field_is_no_steeper() -> None:
    world = World()
    size = world.values.param("size")
    live = scaling(world.values, size, 1.0, 2.0).after(translation(world.values, size, 0, 0))
    assert lipschitz(world).constant(world.moved(live, world.apply("box")), LARGE) == 1.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("field wild() = sqrt(abs(p.x)) + p.y bounds [-1, -1, -1] .. [1, 1, 1]", "over its box: `sqrt` is steep"),
        ("field wild() = p.y - floor(3 * p.x) bounds [-1, -1, -1] .. [1, 1, 1]", "over its box: `floor` jumps"),
        ("field wild() = p.x * p.y - 1", "it has no bounds"),
    ],
)
def test_where_there_is_no_bound_the_field_is_named(text: str, words: str) -> None:
    world = World()
    world.declare(text)
    shape = world.apply("wild")
    assert not lipschitz(world).is_global(shape)
    with pytest.raises(SceneError, match=f"no bound of the slope of 'wild' could be found.*{words}") as caught:
        lipschitz(world).constant(shape, everything())
    assert caught.value.diagnostics[0].span is shape.span
    hint = str(caught.value.diagnostics[0].hint)
    assert "claim one" in hint and ("& box" in hint) == ("no bounds" in words)  # no box where one stands


def test_bounds_of_the_solid_alone_do_not_bound_its_blends() -> None:
    field = "field wild() = d / (1 + abs(d)) where d = length(p) - 1 bounds [-1, -1, -1] .. [1, 1, 1]"
    text = f"{field}\nscene {{ union(blend: 0.1) {{ wild() box(size: [1, 1, 1]).translate([1, 0, 0]) }} }}"
    with pytest.raises(SceneError, match=r"slope of 'wild' .* its bounds say nothing of where it is above zero"):
        pipeline.compile_scene(pipeline.load(Source("wild.sdf", text), None))


def test_a_field_of_the_scenes_params_alone() -> None:
    """It has no argument that would say which graph it is of."""
    world = World()
    world.values.input("p")
    world.declare("field free() = length(p) * 3 - 1 bounds [-1, -1, -1] .. [1, 1, 1]")
    assert math.isclose(lipschitz(world).constant(world.apply("free"), LARGE), 3.0, rel_tol=0.03)


def test_deep_nests_take_little_time() -> None:
    world = World()
    shape = world.apply("sphere")
    for _ in range(1000):
        shape = world.apply("displace", world.at(1e-4, 0, 0, shape), amplitude=1e-5, wavelength=1.0)
    assert math.isclose(lipschitz(world).constant(shape, LARGE), 1 + 1000e-5 * 2 * math.pi)
