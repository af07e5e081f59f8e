"""Level boxes hold every point whose value is at most the level, whatever the params."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import (
    SOLIDS,
    SPAN,
    USER_SOLIDS,
    Array,
    Menu,
    World,
    checked,
    points_around,
    profiles,
    seeds,
    solids,
    some_params,
)

from sdfc.facts.box import Box, everything, nothing
from sdfc.shape.graph import Shape
from sdfc.shape.matrix import matrix, rotation, scaling

LEVELS = (-0.2, 0.0, 0.05, 0.6)


def check_boxes(world: World, shape: Shape, seed: int, levels: tuple[float, ...] = LEVELS) -> None:
    generator = np.random.default_rng(seed)
    for _ in range(3):
        params = some_params(generator)
        points = points_around(generator, 1500, shape.dimension)
        value = world.value(shape, points, params)
        for level in levels:
            assert_held(world.bounds.box(shape, level), points[:, value <= level])


def assert_held(box: Box, points: Array) -> None:
    slack = 1e-9 * (1 + np.abs(points).max(axis=0, initial=0.0))
    low, high = np.array(box.lo)[:, None] - slack, np.array(box.hi)[:, None] + slack
    outside = ~((points >= low) & (points <= high)).all(axis=0)
    assert not outside.any(), (box, points[:, outside][:, :1])


@checked
@given(data=st.data(), seed=seeds)
def test_every_point_is_in_the_box_of_its_level(data: st.DataObject, seed: int) -> None:
    world = World()
    check_boxes(world, data.draw(solids(world)), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_the_same_with_fields_that_users_wrote(data: st.DataObject, seed: int) -> None:
    world = World()
    menu = Menu(solids=SOLIDS | USER_SOLIDS, two_children={"smooth_union": ("blend",)}, lifts={})
    check_boxes(world, data.draw(solids(world, menu)), seed)


@checked
@given(data=st.data(), seed=seeds)
def test_the_same_in_the_plane(data: st.DataObject, seed: int) -> None:
    world = World()
    check_boxes(world, data.draw(profiles(world)), seed)


@pytest.mark.parametrize("level", [-1.0, 0.0, 0.3, 1e6, math.inf])
def test_the_empty_and_the_whole(level: float) -> None:
    world = World()
    empty = world.shapes.nothing(SPAN)
    assert world.bounds.box(empty, level).is_empty
    assert world.bounds.box(world.shapes.complement(empty, SPAN), level) == everything()
    assert world.bounds.box(world.shapes.union([], SPAN), level).is_empty
    ball = world.apply("sphere", radius=0.5)
    assert world.bounds.box(world.shapes.intersection([ball, empty], SPAN), level).is_empty
    turned = world.moved(rotation(world.values, 0, world.values.param("turn")), empty)
    assert world.bounds.box(turned, level).is_empty


def test_what_is_made_of_an_empty_profile_is_an_empty_solid() -> None:
    world = World()
    box = world.bounds.box(world.apply("extrude", world.shapes.nothing(SPAN, 2)))
    assert box.is_empty and len(box.lo) == 3


def test_an_operation_may_fill_what_is_empty() -> None:
    world = World()
    world.declare("field outside(shape: solid) = -shape(p)")
    assert world.bounds.box(world.apply("outside", world.shapes.nothing(SPAN))) == everything()


def test_a_box_for_one_level_is_no_box_for_others() -> None:
    world = World()
    world.declare("field kept(shape: solid) = max(shape(p), length(p) - 1) bounds [-1, -1, -1] .. [1, 1, 1]")
    kept = world.apply("kept", world.apply("plane"))
    assert world.bounds.box(kept) == Box((-1.0,) * 3, (1.0,) * 3)
    check_boxes(world, kept, 1)


def test_the_box_of_a_negative_level_is_right_for_every_scale() -> None:
    world = World()
    size = world.values.param("size")
    radii = world.values.constant(0.9, 0.9, 0.9)
    grown = world.moved(scaling(world.values, size, size, size), world.apply("ellipsoid", radii=radii))
    check_boxes(world, grown, 2, (-0.8, -0.3))


def test_a_box_moved_is_as_tight_as_the_numbers_say() -> None:
    world = World()
    ball = world.apply("sphere", radius=0.5)
    world.bounds.box(ball)
    half = world.at(1.0, 2.0, 3.0, world.moved(scaling(world.values, 2, 2, 2), ball))
    assert world.bounds.box(half) == Box((0.0, 1.0, 2.0), (2.0, 3.0, 4.0))
    shift = world.values.param("shift", world.values.constant(0, 0, 0).type)
    live = matrix(world.values, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [shift[0], shift[1], shift[2]])
    assert world.bounds.box(world.moved(live, ball)) == Box((-1.3, -0.7, -0.5), (1.0, 1.2, 0.9))


def test_boxes_without_end_move() -> None:
    sea = Box((-math.inf, -math.inf, -1.0), (math.inf, 1.0, math.inf))
    moved = sea.moved([1.0, 1.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 5.0])
    assert moved == Box((-math.inf, -2.0, 5.0), (math.inf, math.inf, 5.0))
    assert nothing().moved([1.0, 0.0, 0.0] * 3 + [0.0] * 3).is_empty


def test_boxes_of_deep_trees() -> None:
    world = World()
    shape = world.apply("sphere", radius=0.5)
    for _ in range(3000):
        shape = world.apply("round", world.at(1e-3, 0, 0, shape), radius=1e-4)
    box = world.bounds.box(shape)
    assert math.isclose(box.hi[0], 0.5 + 3.0 + 0.3) and math.isclose(box.lo[0], 3.0 - 0.5 - 0.3)


@pytest.mark.parametrize(
    ("formula", "half"),
    [
        ("dot(p, p) - 1", (1.0, 1.0, 1.0)),
        ("length(p) - 0.7 + 0.1 * sin(5 * p.x) * cos(4 * p.y)", (0.8, 0.8, 0.8)),
        ("max(abs(p.x) - 30, max(abs(p.y), abs(p.z)) - 2)", (30.0, 2.0, 2.0)),
        ("p.y + sin(p.x)", (math.inf, math.inf, math.inf)),
    ],
)
def test_a_formula_without_claims_is_enclosed_by_intervals(formula: str, half: tuple[float, ...]) -> None:
    world = World()
    world.declare(f"field free() = {formula}")
    free = world.apply("free")
    check_boxes(world, free, 3)
    found = world.bounds.box(free).hi
    assert all(h <= f <= 1.2 * h + 0.1 for f, h in zip(found, half, strict=True) if math.isfinite(h))
    assert formula != "p.y + sin(p.x)" or found[1] <= 2.0


def test_a_formula_that_is_nowhere_negative_is_empty() -> None:
    world = World()
    world.declare("field free() = dot(p, p) + 1")
    assert world.bounds.box(world.apply("free")).is_empty
    assert not world.bounds.box(world.apply("free"), 2.0).is_empty


def test_an_enclosure_holds_for_every_value_of_the_params() -> None:
    world = World()
    world.declare("field free(size: length) = length(p) - size")
    free = world.apply("free", size=world.values.param("size"))
    check_boxes(world, free, 4)
    assert 1.4 <= world.bounds.box(free).hi[0] <= 1.6


def test_a_box_that_float32_cannot_hold_is_none() -> None:
    world = World()
    shape = world.apply("sphere", radius=0.5)
    for _ in range(300):
        shape = world.apply("twist", shape)
    box = world.bounds.box(shape)
    assert box.hi[0] == math.inf and box.hi[1] == 0.5


@given(st.lists(st.floats(-1e6, 1e6), min_size=6, max_size=6))
def test_a_rounded_box_holds_the_box_and_hardly_more(ends: list[float]) -> None:
    box = Box(tuple(map(min, ends[:3], ends[3:])), tuple(map(max, ends[:3], ends[3:])))
    wide = box.rounded()
    assert all(a <= b for a, b in zip(wide.lo, box.lo, strict=True))
    assert all(a >= b for a, b in zip(wide.hi, box.hi, strict=True))
    assert max(b - a for a, b in zip(wide.lo, box.lo, strict=True)) <= 4e-12 * max(map(abs, ends)) + 1e-12


def test_boxes_that_rounding_tells_apart_are_one_rounded() -> None:
    for size in (0.5, 0.6, 1.0, 0.1, 3.0):
        boxes = {Box((-size * (1 + n * 1e-16),) * 3, (size * (1 + n * 1e-16),) * 3).rounded() for n in range(-4, 5)}
        assert len(boxes) == 1
