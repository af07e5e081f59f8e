"""Operators, blocks, chains, transforms, the camera and lights: what a scene is made of."""

import math

import numpy as np
import pytest
from language_scenes import applied, messages, root, scene, the

from sdfc.scene.model import PointLight, Sun
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.matrix import Matrix


def numbers(matrix: Matrix) -> np.ndarray:
    """4 by 4."""
    rows = [[e.number for e in row] + [shift.number] for row, shift in zip(matrix.linear, matrix.offset, strict=True)]
    return np.array([*rows, [0, 0, 0, 1]])


def moved(text: str) -> np.ndarray:
    """The matrix of a chain of transforms of a sphere, as 4 by 4; the inverse is checked on the way."""
    shape: Shape = root(f"sphere(1){text}")
    whole = np.eye(4)
    while isinstance(shape, Affine):
        forward = numbers(shape.forward)
        assert numbers(shape.inverse) @ forward == pytest.approx(np.eye(4), abs=1e-12)
        whole = whole @ forward
        shape = shape.child
    assert isinstance(shape, Apply)
    return whole


def turn(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    made = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    made[i, i], made[i, j], made[j, i], made[j, j] = c, -s, s, c
    return made


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        (".translate([1, 2, 3])", [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]]),
        (".translate(x: 1, z: 3)", [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 3]]),
        (".scale(2)", [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]),
        (".scale([1, 2, 3])", [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 3, 0]]),
        (".scale(y: -2)", [[1, 0, 0, 0], [0, -2, 0, 0], [0, 0, 1, 0]]),
        (".mirror(x: true, z: true)", [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]]),
        (".mirror([0, 2, 0])", [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0]]),
        (".mirror([1, 1, 0])", [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0]]),
        (".shear(xy: 0.5, zx: 2)", [[1, 0.5, 0, 0], [0, 1, 0, 0], [2, 0, 1, 0]]),
        (".rotate(y: 90deg)", [[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0]]),
        (".transform(rows: [[1, 2, 3, 4], [0, 1, 5, 6], [0, 0, 2, 7]])", [[1, 2, 3, 4], [0, 1, 5, 6], [0, 0, 2, 7]]),
        (".transform(rows: [[0, 1, 0], [1, 0, 0], [0, 0, 1]], offset: [1, 2, 3])",
         [[0, 1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]]),
        (".translate(x: 1).scale(2)", [[2, 0, 0, 2], [0, 2, 0, 0], [0, 0, 2, 0]]),
    ],
)  # fmt: skip
def test_transforms(text: str, rows: list[list[float]]) -> None:
    assert moved(text)[:3] == pytest.approx(np.array(rows), abs=1e-15)


def test_a_rotation_about_several_axes_is_about_x_first() -> None:
    expected = turn(2, 0.3) @ turn(1, 0.2) @ turn(0, 0.1)
    assert moved(".rotate(x: 0.1rad, y: 0.2rad, z: 0.3rad)") == pytest.approx(expected)


def test_a_rotation_about_any_axis() -> None:
    assert moved(".rotate(0.7rad, axis: [0, 3, 0])") == pytest.approx(turn(1, 0.7))
    made = moved(".rotate(angle: 2rad, axis: [1, 2, 2])")
    assert made[:3, :3] @ np.array([1, 2, 2]) == pytest.approx([1, 2, 2])
    assert np.trace(made[:3, :3]) == pytest.approx(1 + 2 * math.cos(2))


def test_quarter_turns_are_exact() -> None:
    assert set(moved(".rotate(x: 90deg, y: 180deg, z: -270deg)").flatten()) <= {-1.0, 0.0, 1.0}


def test_in_the_plane() -> None:
    made = the(Apply, root("rectangle(1).rotate(90deg).translate([1, 2]).scale([2, 3]).extrude(1)"))
    shape, whole = made.children[0], np.eye(4)
    assert shape.dimension == 2
    while isinstance(shape, Affine):
        whole, shape = whole @ numbers(shape.forward), shape.child
    assert whole[:3] == pytest.approx(np.array([[0, -2, 0, 2], [3, 0, 0, 6], [0, 0, 1, 0]]), abs=1e-15)


def test_operators() -> None:
    union = the(Union, root("sphere(1) | sphere(2) | sphere(3)"))
    assert len(union.children) == 3
    difference = the(Intersection, root("sphere(1) - sphere(2) - sphere(3)"))
    assert [type(c) for c in difference.children] == [Apply, Complement, Complement]
    assert len(the(Intersection, root("sphere(1) & sphere(2)")).children) == 2
    assert isinstance(root("~sphere(1)"), Complement)


def test_calls_and_blocks_mean_the_same() -> None:
    for text in ("union(sphere(1), box())", "union { sphere(1) box() }", "union { sphere(1), box() }",
                 "union(sphere(1)) { box() }", "union([sphere(1), box()])", "sphere(1) | box()"):  # fmt: skip
        made = the(Union, root(text))
        assert applied(made) == ["sphere", "box"], text
    assert applied(root("difference { sphere(1) box() }")) == applied(root("sphere(1) - box()"))
    assert isinstance(root("difference { sphere(1) box() }"), Intersection)


def test_equal_shapes_are_one() -> None:
    made = the(Union, root("for i in 0..3: sphere(1)"))
    assert len(set(made.children)) == 1


def test_smooth_and_chamfered() -> None:
    assert applied(root("union(blend: 0.1) { sphere(1) box() }")) == ["sphere", "box", "smooth_union"]
    made = root("difference(blend: 0.1, kernel: cubic) { sphere(1) box() }")
    assert applied(made) == ["sphere", "box", "smooth_intersection_cubic"]
    assert isinstance(the(Apply, made).children[1], Complement)
    assert applied(root("intersection(chamfer: 0.1) { sphere(1) box() }"))[-1] == "chamfer_intersection"
    assert applied(root("union(blend: 0.1, kernel: quadratic, sphere(1), box(), torus())"))[-1] == "smooth_union"
    assert isinstance(root("union(blend: 0) { sphere(1) box() }"), Union)


def test_a_smooth_union_keeps_the_order_written() -> None:
    made = the(Apply, root("union(blend: 0.1) { sphere(1) sphere(2) sphere(3) }"))
    first = the(Apply, made.children[0])
    assert [the(Apply, c).arguments[0].number for c in first.children] == [1.0, 2.0]  # type: ignore[union-attr]


def test_an_operation_is_chained_called_or_given_a_block() -> None:
    for text in ("box().round(0.1)", "round(box(), 0.1)", "round(radius: 0.1) { box() }", "box().round(radius: 0.1)"):
        made = the(Apply, root(text))
        assert applied(made) == ["box", "round"], text
        assert made.arguments[0].number == 0.1  # type: ignore[union-attr]
    assert applied(root("morph(sphere(1), box(), 0.5)")) == ["sphere", "box", "morph"]
    assert applied(root("sphere(1).morph(box(), 0.5)")) == ["sphere", "box", "morph"]
    assert applied(root("morph(amount: 0.5) { sphere(1) box() }")) == ["sphere", "box", "morph"]


def test_an_operation_on_solids_also_takes_shapes_in_the_plane_where_its_formula_does() -> None:
    made = the(Apply, root("rectangle(1).round(0.1).extrude(1)"))
    rounded = the(Apply, made.children[0])
    assert rounded.dimension == rounded.definition.dimension == 2
    assert messages("scene { rectangle(1).twist(1).extrude(1) }") == [
        "expected a shape in space, not one in the plane"
    ]  # fmt: skip
    assert applied(root("union(blend: 0.1) { circle(1) rectangle(1) }.revolve()")) != []


def test_functions_make_shapes_and_are_chained() -> None:
    made = scene("def wreath(n, r = 1) = union(for i in 0..n: sphere(0.1).translate(x: r).rotate(y: i * 360deg / n))\n"
                 "def lifted(shape, h) = shape.translate(y: h)\nscene { wreath(5).lifted(2) }")  # fmt: skip
    assert len(the(Union, the(Affine, made.root).child).children) == 5
    assert not made.warnings


def test_a_scene_is_the_union_of_what_it_lists() -> None:
    assert len(the(Union, root("sphere(1) box() for i in 0..3: sphere(i + 2)")).children) == 5
    assert isinstance(root("box()"), Apply)
    assert isinstance(root(""), Nothing)
    assert isinstance(root("nothing | nothing"), Union)


def test_materials() -> None:
    made = scene("material gold { color: #ffcf5c, metallic: 1 roughness: 0.15 }\n"
                 "scene { sphere(1).material(gold) box().material(gold) torus().material(color: #f00) }")  # fmt: skip
    first, second, third = (the(Paint, c).material for c in the(Union, made.root).children)
    assert first is second and first.name == "gold"
    assert first.metallic.number == 1.0 and first.roughness.number == 0.15 and first.ior.number == 1.5
    assert third.color.numbers == (1.0, 0.0, 0.0) and third.metallic.number == 0.0


def test_camera_lights_and_sky() -> None:
    made = scene("camera { eye: [1, 2, 3], target: [0, 1, 0], fov: 30deg }\nlight sun { direction: [0, -1, 0] }\n"
                 "light { position: [1, 1, 1] color: #f00 intensity: 5 }\nsky { horizon: #fff } scene { }")  # fmt: skip
    camera = made.camera
    assert camera is not None and camera.height is None
    assert (camera.eye.numbers, camera.target.numbers, camera.up.numbers) == ((1, 2, 3), (0, 1, 0), (0, 1, 0))
    assert camera.fov.number == math.radians(30)
    sun, lamp = made.lights
    assert isinstance(sun, Sun) and sun.direction.numbers == (0, -1, 0) and sun.color.numbers == (1, 1, 1)
    assert isinstance(lamp, PointLight) and lamp.intensity.number == 5 and lamp.color.numbers == (1, 0, 0)
    assert made.sky is not None and made.sky.horizon.numbers == (1, 1, 1)


def test_a_scene_without_a_camera() -> None:
    made = scene("scene { box() }")
    assert made.camera is None and made.sky is None and made.lights == ()


def test_a_camera_without_perspective_and_one_from_above() -> None:
    made = scene("camera { eye: [0, 5, 0], height: 3 }\nscene { box() }").camera
    assert made is not None and made.height is not None and made.height.number == 3
    assert made.up.numbers == (0, 0, -1)
