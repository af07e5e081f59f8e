"""Extrusions and solids of revolution that become primitives: the same solids, in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import SPAN, Menu, World, checked, points_around, seeds, solids, some_params

from sdfc.diagnostics import Source
from sdfc.passes.convex import convex_sides
from sdfc.passes.recognise import LEAVES, recognise
from sdfc.pipeline import compile_scene, load, normalise
from sdfc.plan.steps import Closed, Many, leaves_of
from sdfc.scene.define import IN_PLANE
from sdfc.shape.definition import Argument
from sdfc.shape.graph import Apply, Shape, topological
from sdfc.shape.matrix import rotation, scaling, translation
from sdfc.shape.verify import verify

PENTAGON = ((0.0, -0.5), (0.6, -0.2), (0.6, 0.1), (0.4, 0.5), (-0.5, 0.3))
ARROW = ((-0.5, -0.5), (0.0, -0.2), (0.5, -0.5), (0.0, 0.5))


def recognised(shape: Shape, world: World) -> Shape:
    return recognise(shape, world.shapes, world.values, world.library.definition)


def names(shape: Shape) -> set[str]:
    return {node.definition.name for node in topological(shape) if isinstance(node, Apply)}


def corners(world: World, points: tuple[tuple[float, float], ...]) -> tuple[Argument, ...]:
    return tuple(world.values.constant(*p) for p in points)  # type: ignore[return-value]


def check_same_solid(world: World, before: Shape, after: Shape, seed: int = 1) -> None:
    generator = np.random.default_rng(seed)
    params, points = some_params(generator), points_around(generator, 6000, spread=1.0)
    was, now = world.value(before, points, params), world.value(after, points, params)
    changed = ((was < 0) != (now < 0)) & (np.abs(was) > 1e-9)
    assert not changed.any(), (points[:, changed][:, 0], was[changed][0], now[changed][0])
    assert (was < 0).any() and (was > 0).any()


def profile_of(world: World, name: str) -> Shape:
    if name == "polygon":
        return world.apply("polygon", points=corners(world, PENTAGON))  # type: ignore[arg-type]
    return world.apply(name)


@pytest.mark.parametrize("name", LEAVES)
def test_an_extrusion_is_the_same_solid(name: str) -> None:
    world = World()
    turn = rotation(world.values, 2, world.values.constant(0.7))
    moves = [
        translation(world.values, 0.2, -0.1, 0.0),
        scaling(world.values, 1.3, 1.3, 1.0).after(turn),
        scaling(world.values, -1.2, 0.7, 1.0).after(turn),
        scaling(world.values, world.values.param("size"), 0.8, 1.0),
    ]
    for profile in [profile_of(world, name), *(world.moved(m, profile_of(world, name)) for m in moves)]:
        before = world.apply("extrude", profile, height=0.7)
        after = recognised(before, world)
        verify(after)
        assert not {"extrude", name} & names(after)
        assert all(n.definition.claims.ray for n in topological(after) if isinstance(n, Apply))
        check_same_solid(world, before, after)


@pytest.mark.parametrize("sides", [3, 4, 5, 8])
def test_what_is_exact_stays_exact(sides: int) -> None:
    world = World()
    turn = scaling(world.values, 1.3, 1.3, 1.0).after(rotation(world.values, 2, world.values.constant(0.7)))
    for profile in (world.apply("circle"), world.apply("regular_polygon", sides=float(sides)), world.apply("ring")):
        before = world.apply("extrude", world.moved(turn, profile), height=0.7)
        points = points_around(np.random.default_rng(3), 3000)
        was, now = world.value(before, points, {}), world.value(recognised(before, world), points, {})
        np.testing.assert_allclose(now, was, atol=1e-12)


def test_booleans_of_profiles_become_booleans_of_solids() -> None:
    world = World()
    square, hole = (
        world.apply("rectangle"),
        world.moved(translation(world.values, 0.3, 0.2, 0.0), world.apply("circle")),
    )
    graph = world.shapes
    red, blue = world.material("red"), world.material("blue")
    for profile in (
        graph.difference(square, [hole], SPAN),
        graph.union([hole, graph.difference(square, [world.apply("circle", radius=0.2)], SPAN)], SPAN),
        graph.complement(square, SPAN),
        graph.intersection([graph.complement(square, SPAN), graph.complement(hole, SPAN)], SPAN),
        graph.union([graph.paint(red, square, SPAN), graph.paint(blue, hole, SPAN)], SPAN),
        graph.union([square, graph.nothing(SPAN, 2)], SPAN),
    ):
        before = world.apply("extrude", profile, height=0.7)
        after = recognised(before, world)
        verify(after)
        assert "extrude" not in names(after)
        check_same_solid(world, before, after)


@pytest.mark.parametrize("profile", ["star", "arrow", "live", "rounded", "smooth"])
def test_what_has_no_solid_stays(profile: str) -> None:
    world = World()
    size = world.values.param("size")
    live = (*corners(world, PENTAGON[1:]), world.values.vector(0.0, -0.5 * size))
    made = {
        "star": world.apply("star"),
        "arrow": world.apply("polygon", points=corners(world, ARROW)),  # type: ignore[arg-type]
        "live": world.apply("polygon", points=live),  # type: ignore[arg-type]
        "rounded": world.apply("rounded_rectangle"),
        "smooth": world.apply("smooth_union" + IN_PLANE, world.apply("circle"), world.apply("rectangle")),
    }[profile]
    extrusion = world.apply("extrude", world.shapes.union([made, world.apply("circle")], SPAN))
    assert recognised(extrusion, world) is extrusion


def test_what_an_operation_changes_stays() -> None:
    world = World()
    inner = world.apply("extrude", world.apply("polygon", points=corners(world, PENTAGON)))  # type: ignore[arg-type]
    rounded = world.apply("round", inner)
    both = world.shapes.union([rounded, inner], SPAN)
    after = recognised(both, world)
    assert {"round", "extrude", "convex_polyhedron"} <= names(after)
    assert rounded.id in {node.id for node in topological(after)}


@pytest.mark.parametrize(
    ("name", "x", "wanted"),
    [
        ("circle", 0.0, "sphere"),
        ("circle", 0.8, "torus"),
        ("circle", 0.3, "revolve"),
        ("rectangle", 0.0, "cylinder"),
        ("rectangle", 0.5, "cylinder"),
        ("rectangle", 0.9, "tube"),
        ("star", 0.8, "revolve"),
    ],
)
@pytest.mark.parametrize("offset", [0.0, 0.25])
def test_what_is_revolved(name: str, x: float, wanted: str, offset: float) -> None:
    world = World()
    turn = translation(world.values, x - offset, -0.3, 0.0).after(
        rotation(world.values, 2, world.values.constant(math.pi))
    )
    profile = world.moved(turn, world.shapes.paint(world.material("red"), world.apply(name), SPAN))
    before = world.apply("revolve", profile, offset=offset)
    after = recognised(before, world)
    verify(after)
    assert wanted in names(after)
    check_same_solid(world, before, after)


def test_a_tilted_rectangle_is_revolved_as_it_is() -> None:
    world = World()
    tilted = world.moved(rotation(world.values, 2, world.values.constant(0.3)), world.apply("rectangle"))
    before = world.apply("revolve", tilted, offset=1.0)
    assert recognised(before, world) is before


def test_convex_polygons() -> None:
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)]
    assert len(convex_sides(square)) == len(convex_sides(square[::-1])) == 4
    assert len(convex_sides(PENTAGON)) == 5 and all(side.offset > 0.0 for side in convex_sides(PENTAGON))
    star = [(math.cos(0.8 * math.pi * i), math.sin(0.8 * math.pi * i)) for i in range(5)]
    spike = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 0.0), (0.5, 1.0)]
    flat = [(0.0, 0.0), (1.0, 0.0), (0.5, 0.0)]
    for other in (ARROW, star, spike, flat, square[:2], [(math.nan, 0.0), (1.0, 0.0), (0.0, 1.0)]):
        assert convex_sides(other) == []


def test_a_scene_is_traced_in_closed_form() -> None:
    text = """
        material steel { color: #888888 }
        def plate() = (rectangle(size: [2, 1]) - circle(radius: 0.2).translate([0.5, 0])).extrude(height: 0.2)
        scene {
            plate().rotate(x: 20deg).material(steel)
            regular_polygon(sides: 5).extrude().translate([0, 2, 0])
            polygon(points: [[0, 0], [1, 0], [0.2, 1]]).extrude(height: 0.5).scale([1, 2, 1])
            rectangle(size: [0.2, 1]).translate([2, 0]).revolve()
        }
    """
    scene = load(Source("t.sdf", text))
    compiled = compile_scene(scene)
    assert all(isinstance(leaf, Closed | Many) for leaf in leaves_of(compiled.plan.root))
    root, _ = normalise(scene)
    assert names(root) == {"box", "cylinder", "prism", "convex_polyhedron", "tube"}
    assert "steel" in compiled.materials


@checked
@given(data=st.data(), seed=seeds)
def test_any_tree_stays_the_same_solid(data: st.DataObject, seed: int) -> None:
    world = World()
    shape = data.draw(solids(world, Menu(materials=True)))
    after = recognised(shape, world)
    verify(after)
    generator = np.random.default_rng(seed)
    params, points = some_params(generator), points_around(generator, 1500)
    was, now = world.value(shape, points, params), world.value(after, points, params)
    assert not (((was < 0) != (now < 0)) & (np.abs(was) > 1e-7)).any()
    assert recognised(after, world) is after
