"""What each pass does to shapes that are easily got wrong."""

from __future__ import annotations

import numpy as np
import pytest
from shape_trees import SPAN, World

from sdfc.facts.box import Box
from sdfc.passes.flatten import flatten
from sdfc.passes.negate import negate
from sdfc.passes.own_origin import frame_of
from sdfc.passes.paint import paint
from sdfc.passes.place import place
from sdfc.passes.prune import prune
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, topological
from sdfc.shape.matrix import identity, rotation, scaling, translation


def names(shape: Shape) -> list[str]:
    """The fields below a shape, in order."""
    return [node.definition.name for node in topological(shape) if isinstance(node, Apply)]


def materials(shape: Shape) -> dict[str, str]:
    """The material of each painted field."""
    return {node.child.definition.name: node.material.name for node in topological(shape) if isinstance(node, Paint)}  # type: ignore[union-attr]


# --- flatten


def test_the_empty_and_the_whole_vanish() -> None:
    w = World()
    ball, empty = w.apply("sphere"), w.shapes.nothing(SPAN)
    whole = w.shapes.complement(empty, SPAN)
    flat = [
        (w.shapes.union([ball, empty], SPAN), ball),
        (w.shapes.union([ball, whole], SPAN), whole),
        (w.shapes.union([empty, empty], SPAN), empty),
        (w.shapes.intersection([ball, whole], SPAN), ball),
        (w.shapes.intersection([ball, empty, whole], SPAN), empty),
        (w.shapes.intersection([whole, whole], SPAN), whole),
        (w.at(1, 0, 0, w.shapes.paint(w.material("m"), whole, SPAN)), whole),
        (w.shapes.complement(w.shapes.complement(w.shapes.union([ball], SPAN), SPAN), SPAN), ball),
    ]
    for given, wanted in flat:
        assert flatten(given, w.shapes) is wanted


def test_nests_keep_their_order_and_lose_doubles() -> None:
    w = World()
    a, b, c = w.apply("sphere"), w.apply("box"), w.apply("torus")
    inner = w.shapes.union([b, a], SPAN)
    twice = w.shapes.complement(w.shapes.complement(w.shapes.union([c, inner], SPAN), SPAN), SPAN)
    flat = flatten(w.shapes.union([a, twice, inner], SPAN), w.shapes)
    assert isinstance(flat, Union) and flat.children == (a, c, b)


def test_a_union_that_others_need_stays_one() -> None:
    w = World()
    a, b = w.apply("sphere"), w.apply("box")
    inner = w.shapes.union([a, b], SPAN)
    flat = flatten(w.shapes.union([inner, w.at(3, 0, 0, inner)], SPAN), w.shapes)
    assert isinstance(flat, Union) and flat.children == (a, b, w.at(3, 0, 0, inner))


# --- paint


def test_the_nearest_material_wins() -> None:
    w = World()
    red, blue = w.material("red"), w.material("blue")
    inner = w.shapes.paint(red, w.apply("sphere"), SPAN)
    whole = w.shapes.paint(blue, w.shapes.union([inner, w.apply("box")], SPAN), SPAN)
    assert materials(paint(whole, w.shapes)) == {"sphere": "red", "box": "blue"}


@pytest.mark.parametrize(("cutter", "wanted"), [(False, "red"), (True, "green")])
def test_a_cut_shows_what_is_cut(cutter: bool, wanted: str) -> None:
    w = World()
    base = w.shapes.paint(w.material("red"), w.apply("sphere"), SPAN)
    tool = w.shapes.paint(w.material("green"), w.apply("box"), SPAN) if cutter else w.apply("box")
    cut = w.shapes.paint(w.material("blue"), w.shapes.difference(base, [tool], SPAN), SPAN)
    assert materials(paint(cut, w.shapes)) == {"sphere": "red", "box": wanted}


def test_a_cut_of_what_has_no_material_gets_that_of_the_whole() -> None:
    w = World()
    cut = w.shapes.difference(w.apply("sphere"), [w.apply("box")], SPAN)
    assert materials(paint(cut, w.shapes)) == {}
    assert materials(paint(w.shapes.paint(w.material("blue"), cut, SPAN), w.shapes)) == {
        "sphere": "blue",
        "box": "blue",
    }


def test_materials_go_into_operations() -> None:
    w = World()
    blend = w.apply("smooth_union", w.shapes.paint(w.material("red"), w.apply("sphere"), SPAN), w.apply("box"))
    painted = paint(w.shapes.paint(w.material("blue"), w.apply("round", blend), SPAN), w.shapes)
    assert materials(painted) == {"sphere": "red", "box": "blue"}


# --- place


def test_scales_go_into_lengths_and_rigid_maps_stay() -> None:
    w = World()
    turn = rotation(w.values, 1, w.values.constant(0.5))
    placed = place(w.moved(scaling(w.values, 2, 2, 2), w.moved(turn, w.apply("box"))), w.shapes, w.values)
    assert isinstance(placed, Affine) and isinstance(placed.child, Apply)
    assert placed.child.environment["size"].numbers == (2.0, 2.0, 2.0)  # type: ignore[union-attr]


def test_there_and_back_is_nowhere() -> None:
    w = World()
    ball = w.apply("sphere")
    assert place(w.at(1, -2, 3, w.at(-1, 2, -3, ball)), w.shapes, w.values) is ball
    assert (
        place(w.moved(scaling(w.values, -1, 1, 1), w.moved(scaling(w.values, -1, 1, 1), ball)), w.shapes, w.values)
        is ball
    )


def test_axes_across_which_a_primitive_is_its_mirror_image_point_forward() -> None:
    w = World()

    def turned(axis: int, quarters: int, name: str) -> Shape:
        turn = rotation(w.values, axis, w.values.constant(0.5 * np.pi * quarters))
        return place(w.moved(turn, w.apply(name)), w.shapes, w.values)

    rod, cone = turned(2, 1, "cylinder"), turned(0, 2, "cone")
    assert isinstance(rod, Affine) and isinstance(cone, Affine)
    assert [[e.number for e in row] for row in rod.inverse.linear] == [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
    assert rod.forward.after(rod.inverse) == identity(w.values)
    assert [[e.number for e in row] for row in cone.inverse.linear] == [[1, 0, 0], [0, -1, 0], [0, 0, 1]]
    assert turned(1, 2, "box") is w.apply("box")
    plane = turned(0, 2, "plane")
    assert isinstance(plane, Affine) and plane.inverse.linear[1][1].number == -1.0


def test_bumps_move_with_what_they_are_on() -> None:
    w = World()
    bumpy = w.at(0.3, 0.1, 0.0, w.apply("displace", w.apply("sphere"), amplitude=0.2, wavelength=0.7))
    placed = place(bumpy, w.shapes, w.values)
    points = np.random.default_rng(1).uniform(-1, 1, (3, 500))
    assert np.allclose(w.value(bumpy, points, {}), w.value(placed, points, {}))


def test_a_round_hands_its_place_on_to_its_child() -> None:
    w = World()
    placed = place(w.at(1, 0, 0, w.apply("round", w.apply("box"))), w.shapes, w.values)
    assert isinstance(placed, Apply) and isinstance(placed.children[0], Affine)


def test_parts_used_in_two_places_are_in_two_places() -> None:
    w = World()
    pair = w.shapes.union([w.apply("sphere"), w.at(1, 0, 0, w.apply("sphere"))], SPAN)
    placed = place(w.shapes.union([w.at(0, 1, 0, pair), w.at(0, 2, 0, pair)], SPAN), w.shapes, w.values)
    shifts = {tuple(e.number for e in n.forward.offset) for n in topological(placed) if isinstance(n, Affine)}
    assert shifts == {(0, 1, 0), (1, 1, 0), (0, 2, 0), (1, 2, 0)}


# --- negate


def test_a_smooth_difference_is_an_intersection_with_a_complement() -> None:
    w = World()
    blend = w.apply("smooth_union", w.apply("sphere"), w.shapes.complement(w.apply("box"), SPAN))
    negative = negate(w.shapes.complement(blend, SPAN), w.shapes, w.library.definition)
    assert isinstance(negative, Apply) and negative.definition.name == "smooth_intersection"
    assert isinstance(negative.children[0], Complement) and negative.children[1] is w.apply("box")


def test_a_dual_that_is_not_there_leaves_the_operation_alone() -> None:
    w = World()
    w.declare("field mine(a: solid, b: solid) = min(a(p), b(p)) dual other")
    given = w.shapes.complement(w.apply("mine", w.apply("sphere"), w.apply("box")), SPAN)
    assert negate(given, w.shapes, w.library.definition) is given


# --- own_origin


def test_the_frame_of_a_scene_with_a_floor_is_that_of_its_finite_parts() -> None:
    w = World()
    ball = w.at(10, 0, 0, w.moved(scaling(w.values, 2, 2, 2), w.apply("sphere", radius=0.5)))
    frame = frame_of(w.shapes.union([w.apply("plane"), ball], SPAN), w.bounds)
    assert frame.box == Box((9.0, -1.0, -1.0), (11.0, 1.0, 1.0)) and not frame.is_finite
    assert frame.centre == (10.0, 0.0, 0.0) and np.isclose(frame.radius, np.sqrt(3))
    assert frame_of(ball, w.bounds).is_finite


@pytest.mark.parametrize("words", ["nothing", "floor", "whole"])
def test_a_scene_without_finite_parts_has_a_frame(words: str) -> None:
    w = World()
    empty = w.shapes.nothing(SPAN)
    shape = {"nothing": empty, "floor": w.apply("plane"), "whole": w.shapes.complement(empty, SPAN)}[words]
    frame = frame_of(shape, w.bounds)
    assert frame.radius == 1.0 and frame.centre == (0.0, 0.0, 0.0) and not frame.is_finite


def test_the_frame_of_a_deep_scene_with_a_floor() -> None:
    w = World()
    shape = w.apply("plane")
    for i in range(2000):
        shape = w.moved(
            translation(w.values, 0.01, 0, 0), w.shapes.union([shape, w.apply("sphere", radius=0.1 + i)], SPAN)
        )
    assert frame_of(shape, w.bounds).radius > 1999


# --- prune


def two(w: World, gap: float) -> tuple[Shape, Shape]:
    """Two unit boxes side by side."""
    return w.apply("box"), w.at(1.0 + gap, 0, 0, w.apply("box"))


def test_what_does_not_meet_is_nothing() -> None:
    w = World()
    a, b = two(w, 0.1)
    assert isinstance(prune(w.shapes.intersection([a, b], SPAN), w.shapes, w.bounds), Nothing)
    assert prune(w.shapes.difference(a, [b], SPAN), w.shapes, w.bounds) is a
    nearer = two(w, -0.1)[1]
    for kept in (w.shapes.intersection([a, nearer], SPAN), w.shapes.difference(a, [nearer], SPAN)):
        assert prune(kept, w.shapes, w.bounds) is kept


def test_a_complement_of_nothing_is_everything() -> None:
    w = World()
    hollow = w.shapes.complement(w.apply("round", w.shapes.nothing(SPAN)), SPAN)
    other = w.shapes.complement(w.apply("shell", w.shapes.nothing(SPAN)), SPAN)
    pruned = prune(w.shapes.intersection([hollow, other], SPAN), w.shapes, w.bounds)
    assert isinstance(pruned, Complement) and isinstance(pruned.child, Nothing)


def test_what_an_operation_is_applied_to_stays() -> None:
    """Two boxes that nearly meet do meet when they are grown."""
    w = World()
    meet = w.shapes.intersection(two(w, 0.1), SPAN)
    grown = w.apply("offset", meet, distance=0.2)
    assert prune(grown, w.shapes, w.bounds) is grown
    difference = w.apply("shell", w.shapes.difference(two(w, 0.1)[0], [two(w, 0.1)[1]], SPAN))
    assert prune(difference, w.shapes, w.bounds) is difference


@pytest.mark.parametrize("name", ["smooth_union", "smooth_union_cubic", "smooth_union_circular"])
def test_blends_out_of_reach_are_unions(name: str) -> None:
    w = World()
    far, near = w.apply(name, *two(w, 0.65), blend=0.3), w.apply(name, *two(w, 0.55), blend=0.3)
    assert isinstance(prune(far, w.shapes, w.bounds), Union)
    assert prune(near, w.shapes, w.bounds) is near
    live = w.apply(name, *two(w, 0.65), blend=w.values.param("size"))
    assert prune(live, w.shapes, w.bounds) is live


def test_a_blend_without_end_stays() -> None:
    w = World()
    for name in ("smooth_union_exponential", "smooth_union_root", "smooth_union_round"):
        far = w.apply(name, *two(w, 5.0), blend=0.1)
        assert prune(far, w.shapes, w.bounds) is far


def test_a_blend_in_a_blend_is_out_of_reach_of_both() -> None:
    """The inner blend's values matter up to the outer one's width."""
    w = World()
    ball = w.at(0.9, 0.9, 0, w.apply("sphere"))
    inner = w.apply("smooth_union", *two(w, 0.65), blend=0.3)
    outer = w.apply("smooth_union", inner, ball, blend=0.3)
    assert "smooth_union" in names(prune(outer, w.shapes, w.bounds))
    kept = prune(outer, w.shapes, w.bounds)
    assert names(kept).count("smooth_union") == 2
    wide = w.apply("smooth_union", w.apply("smooth_union", *two(w, 2.0), blend=0.3), ball, blend=0.3)
    assert names(prune(wide, w.shapes, w.bounds)).count("smooth_union") == 1


def test_a_blend_with_what_is_empty_is_the_other() -> None:
    w = World()
    a, b = two(w, 3.0)
    assert prune(w.apply("smooth_union", w.shapes.intersection([a, b], SPAN), a), w.shapes, w.bounds) is a


def test_an_intersection_keeps_what_may_meet_for_some_param() -> None:
    w = World()
    shift = w.values.param("shift", w.values.constant(0, 0, 0).type)
    moving = w.moved(translation(w.values, shift[0], shift[1] + 1.1, 0.0), w.apply("box"))
    meet = w.shapes.intersection([w.apply("box"), moving], SPAN)
    assert isinstance(prune(meet, w.shapes, w.bounds), Intersection)
