"""Numbers, units, vectors, colours, lists, functions and params: what an expression comes to."""

import math

import pytest
from language_scenes import argument, messages, root, scene, the

from sdfc.field.graph import Op, Type
from sdfc.shape.graph import Apply


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", (7.0,)),
        ("(1 + 2) * 3 - -1", (10.0,)),
        ("7 / 2 / 2", (1.75,)),
        ("[1, 2, 3] * 2 + 1", (3.0, 5.0, 7.0)),
        ("[1, 2, 3].zyx", (3.0, 2.0, 1.0)),
        ("[1, 2, 3].y", (2.0,)),
        ("[1, 2, 3][2]", (3.0,)),
        ("[5, 6, 7, 8, 9][3]", (8.0,)),
        ("[[1, 2], [3, 4]][1].x", (3.0,)),
        ("2.xx", (2.0, 2.0)),
        ("sin(30deg)", (0.5,)),
        ("sin(pi / 6)", (0.5,)),
        ("cos(0.5rad) - cos(0.5)", (0.0,)),
        ("90deg / 30deg", (3.0,)),
        ("degrees(pi * 1rad)", (180.0,)),
        ("tan(atan(1, 1))", (1.0,)),
        ("tan(asin(1) / 2)", (1.0,)),
        ("degrees(30deg + 2 * 15deg)", (60.0,)),
        ("degrees(max(30deg, 40deg, 10deg))", (40.0,)),
        ("degrees([10deg, 20deg].y)", (20.0,)),
        ("min(3, 1, 2) + max([4, 9, 5])", (10.0,)),
        ("clamp([0, 5], 1, 3)", (1.0, 3.0)),
        ("mix(2, 4, 0.25)", (2.5,)),
        ("step(1, 0.5) + step(1, 2)", (1.0,)),
        ("smoothstep(0, 2, 1)", (0.5,)),
        ("mod(-1, 3) + fract(2.25) + ceil(1.2) + floor(-1.2) + round(2.5)", (2 + 0.25 + 2 - 2 + 3.0,)),
        ("sqrt(16) + pow(2, 3) + exp(0) + log(1) + abs(-2) + sign(-3)", (4 + 8 + 1 + 0 + 2 - 1.0,)),
        ("length([3, 4]) + dot([1, 2, 3], [4, 5, 6])", (37.0,)),
        ("cross([1, 0, 0], [0, 1, 0])", (0.0, 0.0, 1.0)),
        ("normalize([0, 3, 4])", (0.0, 0.6, 0.8)),
        ("sum(for i in 0..4: i * i) + product(for i in 1..5: i)", (14 + 24.0,)),
        ("count([for i in 0..7: [i, i]]) + count([1, 2])", (9.0,)),
        ("sum(for v in [1, 2, 3]: for w in [10, 20]: v * w)", (180.0,)),
        ("sum([for i in 0..5: i])", (10.0,)),
        ("if 1 < 2 and not (3 == 4) or false then 5 else 6", (5.0,)),
        ("if 1 >= 2 or 2 != 2 then 5 else 6", (6.0,)),
        ("if true == (1 < 2) then 1 else 2", (1.0,)),
        ("if false then 1 / 0 else 3", (3.0,)),
        ("sum(for i in 2..2: i)", (0.0,)),
    ],
)
def test_expressions(text: str, value: tuple[float, ...]) -> None:
    assert argument(text) == pytest.approx(value, rel=1e-12, abs=1e-12)


def test_a_branch_that_a_constant_decides_is_not_evaluated() -> None:
    assert argument("if true or 1 / 0 > unknown then 2 else unknown") == (2.0,)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("#fff", (1.0, 1.0, 1.0)),
        ("#808080", (0.21586050011389926,) * 3),
        ("#0a0000", (0.0030352698354883752, 0.0, 0.0)),
    ],
)
def test_colours_are_linear_inside(text: str, value: tuple[float, ...]) -> None:
    painted = scene(f"material m {{ color: {text} }}\nscene {{ sphere(1).material(m) }}").root
    assert painted.material.color.numbers == pytest.approx(value, rel=1e-12)  # type: ignore[union-attr]


def test_a_colour_may_be_computed() -> None:
    made = scene("def base = #ff0000\nmaterial m { color: mix(base, #fff, 0.5) * 0.5 }\nscene { box().material(m) }")
    assert made.root.material.color.numbers == (0.5, 0.25, 0.25)  # type: ignore[union-attr]


def test_angles_are_radians_inside() -> None:
    found = scene("field f(turn: angle) = length(p) - turn\nscene { f(turn: 180deg) }").root
    assert the(Apply, found).arguments[0].number == math.pi  # type: ignore[union-attr]


def test_functions_have_defaults_names_and_local_names() -> None:
    text = "def f(a, b = a * 2, c = a + b) = [x, y, c] where x = a + 1, y = x + b\n"
    field = "field probe(value: vector3) = length(p) * value.x\n"
    found = scene(f"{text}{field}scene {{ probe(value: f(1, c: 9)) | probe(value: f(1)) }}").root
    first, second = found.children  # type: ignore[union-attr]
    assert the(Apply, first).arguments[0].numbers == (2.0, 4.0, 9.0)  # type: ignore[union-attr]
    assert the(Apply, second).arguments[0].numbers == (2.0, 4.0, 3.0)  # type: ignore[union-attr]


def test_a_parameter_hides_what_is_outside() -> None:
    assert messages("def r = 5\ndef f(r) = sphere(r)\nscene { f(0) | sphere(r) }") == [
        "radius must be greater than 0, not 0"
    ]


def test_a_param_stays_live() -> None:
    made = scene("param width = 0.5 in 0.1..2\nparam turn = 10deg in 0deg..90deg\nparam tone = #fff\n"
                 "param at = [0, 1, 0] in -2..2\nmaterial m { color: tone }\n"
                 "scene { sphere(2 * width).rotate(y: turn).translate(at).material(m) }")  # fmt: skip
    width, turn, tone, at = made.params
    assert (width.name, width.type, width.default, width.low, width.high, width.unit) == (
        "width", Type.FLOAT, (0.5,), 0.1, 2.0, "number",
    )  # fmt: skip
    assert turn.default == (math.radians(10),) and turn.high == math.radians(90) and turn.unit == "angle"
    assert (tone.unit, tone.low, tone.high, tone.type) == ("color", 0.0, 1.0, Type.VEC3)
    assert (at.type, at.default, at.low) == (Type.VEC3, (0.0, 1.0, 0.0), -2.0)
    assert not made.warnings
    sphere = made.root.child.child.child  # type: ignore[union-attr]
    radius = the(Apply, sphere).arguments[0]
    assert not isinstance(radius, tuple)
    assert radius.op is Op.MUL and {a.op for a in radius.args} == {Op.PARAM, Op.CONST}


def test_a_param_chooses_between_numbers() -> None:
    made = scene("param on = 0.5 in 0..1\nscene { sphere(if on > 0.5 then 2 else 1) }")
    radius = the(Apply, made.root).arguments[0]
    assert not isinstance(radius, tuple) and radius.op is Op.SELECT


def test_a_size_may_be_one_number() -> None:
    assert the(Apply, root("box(2)")).arguments[0].numbers == (2.0, 2.0, 2.0)  # type: ignore[union-attr]


def test_what_is_never_used_is_a_warning() -> None:
    made = scene("param a = 1 in 0..2\nmaterial m { }\ndef f() = g()\ndef g() = box()\ndef h() = g()\n"
                 "field w(r: length) = length(p) - r\nscene { h() }")  # fmt: skip
    assert [w.message for w in made.warnings] == [
        "the param 'a' is never used",
        "the material 'm' is never used",
        "the def 'f' is never used",
        "the field 'w' is never used",
    ]
    assert {w.severity for w in made.warnings} == {"warning"}


def test_a_function_that_hides_a_shape_of_the_library_is_a_warning() -> None:
    made = scene("def box(a) = sphere(a)\nfield torus() = length(p) - 1\nscene { box(1) torus() }")
    (warning,) = made.warnings
    assert warning.message == "'box' is also a shape or an operation of the library, which this hides"
    assert warning.hint == "give it another name" and warning.severity == "warning"


def test_a_texture_is_a_warning_and_its_first_colour() -> None:
    made = scene("material m { color: checker(#fff, #000, scale: 2) }\nscene { box().material(m) }")
    assert made.root.material.color.numbers == (1.0, 1.0, 1.0)  # type: ignore[union-attr]
    assert [w.message for w in made.warnings] == ["textures are not there yet: this is its first colour"]
