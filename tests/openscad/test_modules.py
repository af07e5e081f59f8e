"""What each module makes, where a table of points does not tell: colours, nothings, warnings, refusals."""

import math

import numpy as np
import pytest
from csg_values import distance, inside, refusal, scene

from sdfc.openscad.modules import MODULES
from sdfc.shape.graph import Nothing, Paint, topological

UNIT = "cube(size = [1, 1, 1], center = true);"


def paints(text: str) -> list[tuple[float, ...]]:
    """The colours in the file, but for the default around everything."""
    made = scene(text)
    assert isinstance(made.root, Paint)
    found = [node for node in topological(made.root.child) if isinstance(node, Paint)]
    return [tuple(round(v, 4) for v in node.material.color.numbers) for node in found]


def test_a_scene_says_what_openscad_says() -> None:
    made = scene(UNIT)
    assert made.camera is None
    assert made.up == (0.0, 0.0, 1.0)
    assert (made.lights, made.sky, made.params, made.warnings) == ((), None, (), ())
    assert isinstance(made.root, Paint)
    assert made.root.material.color.numbers == pytest.approx((0.9473, 0.6795, 0.0252), abs=1e-4)


def test_the_outermost_colour_rules() -> None:
    assert paints(f"color([1, 0, 0, 1]) {{ color([0, 0, 1, 1]) {{ {UNIT} }} }}") == [(1.0, 0.0, 0.0)]
    assert paints(f"color([-1, -1, -1, 1]) {{ color([0, 0, 1, 1]) {{ {UNIT} }} }}") == [(0.0, 0.0, 1.0)]


@pytest.mark.parametrize(
    "text", ['"SteelBlue"', '"#4682b4"', "[0.27450980, 0.50980392, 0.70588235]", 'c = "steelblue"']
)
def test_colours_by_name_and_number(text: str) -> None:
    (color,) = paints(f"color({text}) {{ {UNIT} }}")
    assert color == pytest.approx((0.0612, 0.2232, 0.4564), abs=2e-4)


def test_alpha_lets_light_through_and_one_colour_is_one_material() -> None:
    made = scene(f"color([1, 0, 0, 0.25]) {UNIT} color([1, 0, 0, 0.25]) sphere(r = 2);")
    materials = {id(n.material): n.material for n in topological(made.root) if isinstance(n, Paint)}
    assert len(materials) == 2
    assert sorted(m.transmission.number for m in materials.values()) == [0.0, 0.75]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "group();",
        "group() { group() { } }",
        f"%{UNIT}",
        f"*{UNIT}",
        f"difference() {{ group(); {UNIT} }}",
        f"intersection() {{ {UNIT} group(); }}",
        "cube(size = [0, 1, 1]);",
        "cube(size = [-nan, 1, 1]);",
        "cube(size = [inf, inf, inf]);",
        "cylinder(h = 1, r1 = -1, r2 = 1);",
        "cylinder(h = 1, r1 = 0, r2 = 0);",
        "sphere(r = -1);",
        "linear_extrude(height = 0) { square(size = [1, 1]); }",
        "linear_extrude(height = 1) { square(size = [0, 1]); }",
        "linear_extrude(height = 1) { polygon(points = [[0, 0], [1, 1], [2, 2]], paths = undef); }",
        "linear_extrude(height = 1) { offset(r = -1) { square(size = [1, 9]); } }",
        "rotate_extrude(angle = 0) { square(size = [1, 1]); }",
        "hull();",
        "hull() { linear_extrude(height = 1) { circle(r = 0); } }",
        "minkowski() { cube(size = [1, 1, 1]); group(); }",
        "polyhedron(points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]]);",
    ],
)
def test_nothing(text: str) -> None:
    made = scene(text)
    assert isinstance(made.root, Paint)
    assert isinstance(made.root.child, Nothing)
    assert [w.message for w in made.warnings] == ["nothing remains of this file"]


def test_modifiers() -> None:
    far = "multmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])"
    assert inside(f"{UNIT} #{far} {UNIT}", (0, 0, 0), (5, 0, 0)) == [True, True]
    assert inside(f"{UNIT} {far} {{ !{UNIT} }}", (0, 0, 0), (5, 0, 0)) == [True, False]
    assert inside(f"difference() {{ %sphere(r = 9); {UNIT} }}", (0, 0, 0), (5, 0, 0)) == [True, False]


def test_facets_and_curves() -> None:
    flat, corner = math.cos(math.pi / 6) * 0.99, 0.99
    middle = (flat * math.cos(math.pi / 6), flat * math.sin(math.pi / 6), 0.5)
    beyond = (corner * math.cos(math.pi / 6), corner * math.sin(math.pi / 6), 0.5)
    text = "cylinder($fn = {}, $fa = 12, $fs = 2, h = 1, r1 = 1, r2 = 1, center = false);"
    assert inside(text.format(6), (corner, 0, 0.5), middle, beyond) == [True, True, False]
    for curve in (0, 50, 360):
        assert inside(text.format(curve), (corner, 0, 0.5), middle, beyond) == [True, True, True]
    assert inside(text.format(1), (corner, 0, 0.5), (-0.6, 0, 0.5)) == [True, False]  # fewer than 3 are 3


def test_what_is_in_the_plane_is_shown_one_thick() -> None:
    text = "square(size = [2, 2], center = true);"
    assert inside(text, (0, 0, 0.4), (0, 0, -0.4), (0, 0, 0.6)) == [True, True, False]
    assert "1 thick" in scene(text).warnings[0].message


def test_mixing_dimensions_leaves_out_what_is_not_as_the_first() -> None:
    text = f"union() {{ {UNIT} %sphere(r = 9); group() {{ square(size = [9, 9]); }} }}"
    assert inside(text, (0, 0, 0), (5, 5, 0)) == [True, False]
    (warning,) = scene(text).warnings
    assert warning.message == "`square` is in the plane and left out: what stands first is in space"
    assert warning.span is not None and text[warning.span.start : warning.span.end] == "square"


def test_a_map_of_a_map_is_one_and_the_last_row_is_ignored() -> None:
    move = "multmatrix([[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 7]])"
    back = "multmatrix([[1, 0, 0, -3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])"
    assert inside(f"{move} {{ {move} {{ {UNIT} }} }}", (2, 0, 0), (0, 0, 0)) == [True, False]
    assert scene(f"{move} {move} {move} {back} sphere(r = 1);").root.child is not None
    assert len(scene(f"{move} {move} {move} {back} sphere(r = 1);").shapes) < 7


@pytest.mark.parametrize("name", sorted(set(MODULES) - {"group", "union", "render"}))
def test_every_module_survives_no_arguments(name: str) -> None:
    text = f"{name}() {{ {UNIT} }}"
    try:
        assert np.isfinite(distance(text, [(0.1, 0.2, 0.3)])).all()
    except Exception as error:
        assert type(error).__name__ == "SceneError"


@pytest.mark.parametrize(
    ("text", "place", "says"),
    [
        ('text(text = "a");', "1:1", "`text` has no distance form"),
        ('surface(file = "a.png");', "1:1", "`surface` has no distance form"),
        ('group() { import(file = "a.stl"); }', "1:11", "`import` has no distance form"),
        ("projection(cut = true) { cube(1); }", "1:1", "`projection` has no distance form"),
        ("hull() { sphere(r = 1); cylinder(h = 5, r1 = 3, r2 = 3); cube(9); }", "1:1", "`hull` is exact here for"),
        ("hull() { difference() { sphere(r = 2); cube(1); } cube(1); }", "1:1", "the hull of a difference"),
        ("minkowski() { sphere(r = 1); cylinder(h = 5, r1 = 3, r2 = 3); }", "1:1", "`minkowski` has no distance form"),
        ("minkowski() { union() { cube(1); sphere(r = 1); } cube(1); }", "1:1", "`minkowski` of what is not convex"),
        ("multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]) { cube(1); }", "1:1", "singular"),
        ("multmatrix([[1, 0, 0, 0], [0, 1, 0, inf], [0, 0, 1, 0]]) { cube(1); }", "1:12", "4 finite numbers"),
        ("cube(size = [1, 2]);", "1:6", "`size` of `cube` must be a number or a list of 3 numbers"),
        ("cube(center = 3, size = true);", "1:18", "`size` of `cube`"),
        ('sphere(r = "3");', "1:8", "`r` of `sphere` must be a number"),
        ("cuber(1);", "1:1", "did you mean `cube`?"),
        ('color("octarine") { cube(1); }', "1:7", "a name of the web"),
        ("polygon(points = [[0, 0], [1, 0], [0, 1]], paths = [[0, 1, 3]]);", "1:44", "from 0 to 2"),
        ("polygon();", "1:1", "`polygon` needs `points`"),
        ("rotate_extrude() { square(size = [4, 4], center = true); }", "1:1", "on both sides of the axis"),
        ("linear_extrude(height = 2, scale = [1, 2]) { circle(r = 1); }", "1:1", "x and y differently"),
        ("linear_extrude(height = 2) { offset(delta = 1, chamfer = true) { square(1); } }", "1:30", "cut corners"),
        (
            "linear_extrude(height = 2) { offset(r = 1) { difference() { square(9); circle(1); } } }",
            "1:30",
            "union can grow",
        ),
    ],
)
def test_refusals_name_it_and_its_place(text: str, place: str, says: str) -> None:
    shown = refusal(text)
    assert shown.startswith(f"m.csg:{place}:")
    assert says in shown
    assert "^" in shown


def test_wide_and_deep() -> None:
    move = "multmatrix([[1, 0, 0, {}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])"
    wide = "union() {" + "".join(f"{move.format(i)} {{ sphere($fn = 0, r = 1); }}\n" for i in range(2000)) + "}"
    assert len(scene(wide).shapes) > 2000
    deep = (move.format(1) + " { sphere(r = 1); ") * 2000 + "}" * 2000
    assert len(scene(deep).shapes) > 2000
    assert len(scene("group() { color([1, 0, 0, 1]) { " * 3000 + "cube(1);" + "} }" * 3000).shapes) < 6
