"""Text to calls: values, places, nesting, and what is said about a text that is not flattened CSG."""

import math

import pytest

from sdfc.diagnostics import SceneError, Source, show
from sdfc.openscad.parse import parse


def calls(text: str) -> tuple:
    return parse(Source("m.csg", text))


def value(text: str) -> object:
    (call,) = calls(f"cube(size = {text});")
    return call.arguments[0].value


def error(text: str) -> str:
    with pytest.raises(SceneError) as caught:
        calls(text)
    (diagnostic,) = caught.value.diagnostics
    return show(diagnostic)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", 1.0),
        ("-2.5", -2.5),
        ("1e-05", 1e-5),
        ("1e+10", 1e10),
        (".5", 0.5),
        ("inf", math.inf),
        ("-inf", -math.inf),
        ("true", True),
        ("false", False),
        ("undef", None),
        ('"a b"', "a b"),
        ('"say "hi" now"', 'say "hi" now'),
        ("[]", ()),
        ("[1, 2,3]", (1.0, 2.0, 3.0)),
        ("[ [1, 2], [3, 4] ]", ((1.0, 2.0), (3.0, 4.0))),
        ("[true, undef, [1]]", (True, None, (1.0,))),
    ],
)
def test_values(text: str, expected: object) -> None:
    assert value(text) == expected


def test_nan() -> None:
    assert math.isnan(value("-nan"))  # type: ignore[arg-type]
    (call,) = calls("cube([-nan, 1, nan]);")
    assert math.isnan(call.arguments[0].value[0])


def test_structure_and_places() -> None:
    text = "group() {\n\t%sphere($fn = 0, r = 2);\n\tunion();\n}\ncube([1, 1, 1], center = true);"
    group, cube = calls(text)
    sphere, union = group.children
    assert (sphere.modifiers, sphere.name, union.name) == ("%", "sphere", "union")
    assert [(a.name, a.value) for a in sphere.arguments] == [("$fn", 0.0), ("r", 2.0)]
    assert [(a.name, a.value) for a in cube.arguments] == [(None, (1.0, 1.0, 1.0)), ("center", True)]
    assert text[sphere.start : sphere.end] == "sphere"
    argument = cube.arguments[1]
    assert text[argument.start : argument.end] == "center = true"


def test_comments_and_a_single_child_without_braces() -> None:
    (call,) = calls("// written by hand\ncolor([1, 0, 0]) /* red */ cube(1);")
    assert [child.name for child in call.children] == ["cube"]


def test_depth_is_no_limit() -> None:
    depth = 20_000
    (call,) = calls("group() {" * depth + "cube(1);" + "}" * depth)
    for _ in range(depth):
        (call,) = call.children
    assert call.name == "cube"


def test_no_text_at_all() -> None:
    assert calls("") == ()
    assert calls("\ufeff \n") == ()


@pytest.mark.parametrize(
    ("text", "place", "says"),
    [
        ("cube(", "m.csg:1:5", "the file ends"),
        ("group() {\n", "m.csg:1:9", "the file ends"),
        ("cube(1) }", "m.csg:1:9", "expected"),
        ("cube(size = x);", "m.csg:1:13", "no variables"),
        ("cube([1e]);", "m.csg:1:6", "this is no number"),
        ("cube(1e300);", "m.csg:1:6", "numbers go to"),
        ("cube(@);", "m.csg:1:6", "'@' is not expected here"),
        ("x = 3;", "m.csg:1:3", "no variables"),
    ],
)
def test_errors_have_a_place(text: str, place: str, says: str) -> None:
    shown = error(text)
    assert shown.startswith(place)
    assert says in shown
    assert "^" in shown
