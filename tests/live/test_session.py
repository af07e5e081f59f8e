"""What an edit shows is what a fresh compile shows, and costs no more than it must."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from author import BALLS, Author
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sdfc.diagnostics import SceneError
from sdfc.gpu.program import FragmentProgram
from sdfc.live.session import Speed
from sdfc.live.text import Literal, read

pytestmark = pytest.mark.gpu

ROOT = Path(__file__).parents[2]
SCENES = ["csg5.sdf", "jewel.sdf", "blobs.sdf", "column.sdf", "lamp.sdf", "bracket.sdf"]
SHARE = 0.01  # of the pixels: those on edges, where a rounding decides


def written(literal: Literal, factor: float) -> str:
    """The literal times `factor`, as text."""
    if literal.unit == "color":
        return "#" + "".join(f"{min(255, round(255 * factor * 0.4)):02x}" for _ in range(3))
    value = literal.value[0] * factor
    return f"{value:.6f}rad" if literal.unit == "angle" else f"{value:.6f}"


def edited(text: str, index: int, factor: float) -> str:
    """The text with another value for one literal outside of the camera."""
    literal = read(text).literals[index]
    end = literal.start
    while end < len(text) and (text[end].isalnum() or text[end] in "#.") and text[end : end + 2] != "..":
        end += 1
    return text[: literal.start] + written(literal, factor) + text[end:]


def is_alike(a: Path, b: Path) -> bool:
    """Whether two pictures differ in a few pixels at most."""
    differ = np.abs(np.load(a) - np.load(b)).max(axis=-1) > 0.01 + 0.01 * np.abs(np.load(b)).max(axis=-1)
    return bool(differ.mean() <= SHARE)


@settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
@given(st.data())
def test_any_literal_edited_twice_is_as_if_compiled_anew(opengl: None, data: st.DataObject) -> None:
    text = (ROOT / "scenes" / data.draw(st.sampled_from(SCENES), "scene")).read_text()
    index = data.draw(st.integers(0, len(read(text).literals) - 1), "literal")
    factors = data.draw(st.lists(st.sampled_from([0.6, 0.8, 0.95, 1.1, 1.5]), min_size=2, max_size=3), "factors")
    with tempfile.TemporaryDirectory() as name:
        one, other = Author(Path(name) / "one"), Author(Path(name) / "other")
        one.save(text)
        for factor in factors:
            wanted = edited(text, index, factor)
            try:
                other.session.distrust()
                other.save(wanted)
            except SceneError as error:
                with pytest.raises(SceneError, match=r".") as caught:
                    one.save(wanted)
                assert str(caught.value) == str(error)
            else:
                one.save(wanted)
                assert is_alike(one.picture, other.picture), wanted
        one.session.close()
        other.session.close()


@pytest.mark.parametrize(
    ("old", "edits"),
    [
        ("0.25", ["0.3", "0.35", "0.2"]),  # in a loop
        ("10deg", ["20deg", "0.3rad"]),
        ("#ff2010", ["#10ff20", "#1020ff"]),
        ("3.5", ["5", "4"]),
        ("0.3)", ["0.4)", "0.35)"]),  # given to a field
        ("0.05", ["0.06", "0.04"]),  # in a field's formula
        ("-0.8", ["-0.9", "-1.0"]),
    ],
)
def test_a_number_is_a_uniform_from_its_second_edit_on(
    author: Author, compiled: list[str], old: str, edits: list[str]
) -> None:
    author.save(BALLS)
    assert author.save(BALLS.replace(old, edits[0])).speed is Speed.NEW_SHADER
    pictures = [author.picture.read_bytes()]
    so_far = len(compiled)
    for edit in edits[1:]:
        assert author.save(BALLS.replace(old, edit)).speed is Speed.NUMBERS
        pictures.append(author.picture.read_bytes())
    assert len(compiled) == so_far, "no shader was compiled"
    assert len(set(pictures)) == len(pictures), "and yet each edit is seen"


def test_the_default_of_a_param_is_one_at_once(author: Author, compiled: list[str]) -> None:
    author.save(BALLS)
    assert author.save(BALLS.replace("size = 0.5", "size = 0.8")).speed is Speed.NUMBERS
    assert len(compiled) == 1
    with pytest.raises(SceneError, match="outside of"):
        author.save(BALLS.replace("size = 0.5", "size = 2"))


@pytest.mark.parametrize("behind", ["\n", " // warm\n", "\nmaterial other { color: #112233 }\n"])
def test_so_is_a_color(author: Author, compiled: list[str], behind: str) -> None:
    text = f"param tone = #ff8800{behind}material m {{ color: tone }}\nscene {{ sphere(radius: 1).material(m) }}"
    author.save(text)
    assert author.save(text.replace("#ff8800", "#0088ff")).speed is Speed.NUMBERS
    assert len(compiled) == 1
    author.save(text.replace("#ff8800", "0.5 * #ff8800"))
    edited = text.replace("#ff8800", "0.5 * #0088ff")
    assert author.save(edited).speed is not Speed.NUMBERS, "more than one literal"


def test_what_must_be_known_stays_baked(author: Author) -> None:
    """A loop's end: each edit is a new shader, and the picture is right."""
    author.save(BALLS)
    for count in ("2", "4"):
        update = author.save(BALLS.replace("many = 3", f"many = {count}"))
        assert (update.speed, update.live) == (Speed.NEW_SHADER, 0)


def test_a_table_of_like_parts_does_not_come_undone(author: Author) -> None:
    """A live size would make three hundred formulas of one loop."""
    shutil.copy(ROOT / "scenes" / "spheres.csv", author.scene.with_name("spheres.csv"))
    text = (ROOT / "scenes" / "spheres.sdf").read_text().replace("radius: row.r", "radius: 1.0 * row.r")
    author.save(text)
    for factor in ("1.02", "1.03"):
        update = author.save(text.replace("1.0 * row.r", f"{factor} * row.r"))
        assert (update.speed, update.live) == (Speed.NEW_SHADER, 0)


def test_a_number_that_leaves_its_range_is_compiled_again(author: Author) -> None:
    author.save(BALLS)
    speeds = [author.save(BALLS.replace("0.25", edit)).speed for edit in ("0.3", "0.35", "0.9", "1.0", "0.01")]
    new, numbers = Speed.NEW_SHADER, Speed.NUMBERS
    assert speeds == [new, numbers, new, numbers, new]


def test_sixteen_are_live_and_the_oldest_gives_way(author: Author) -> None:
    lines = [f"    sphere(radius: 0.2).translate([0.5 * {i}, 0.{i + 11}, 0])" for i in range(18)]
    text = "scene {\n" + "\n".join(lines) + "\n}\n"
    author.save(text)
    for i in range(18):
        text = text.replace(f"0.{i + 11},", f"0.{i + 11}5,")
        update = author.save(text)
        assert (update.speed, update.live) == (Speed.NEW_SHADER, min(i + 1, 16))
    assert author.save(text.replace("0.285,", "0.287,")).speed is Speed.NUMBERS, "the last one"
    assert author.save(text.replace("0.115,", "0.116,")).speed is Speed.NEW_SHADER, "the first one"


def test_the_camera_needs_no_shader(author: Author, compiled: list[str]) -> None:
    first = author.save(BALLS)
    before = author.picture.read_bytes()
    moved = author.save(BALLS.replace("eye: [0, 1, 4]", "eye: [1, size, 2 + 3]"))
    assert (first.speed, moved.speed, len(compiled)) == (Speed.NEW_SHADER, Speed.CAMERA, 1)
    assert author.picture.read_bytes() != before
    with pytest.raises(SceneError, match="eye is at its target"):
        author.save(BALLS.replace("eye: [0, 1, 4]", "eye: [0, 0, 0]"))


def test_without_lights_the_sun_stands_behind_the_camera(authors: Callable[[], Author]) -> None:
    text = BALLS.replace("light sun { direction: [-1, -2, -1], intensity: 3.5 }\n", "")
    moved = text.replace("eye: [0, 1, 4]", "eye: [3, 1, 2]")
    one, other = authors(), authors()
    one.save(text)
    one.save(moved)
    other.save(moved)
    assert is_alike(one.picture, other.picture)


def test_without_a_camera_live_ranges_frame_nothing(authors: Callable[[], Author]) -> None:
    text = "scene { sphere(radius: 0.5) - box(size: [0.3, 2, 0.3]) }\n"
    one, other = authors(), authors()
    one.save(text)
    for size in ("0.6", "0.7", "0.8"):
        one.save(text.replace("0.5", size))
    other.save(text.replace("0.5", "0.8"))
    assert is_alike(one.picture, other.picture)


def test_comments_and_blanks_draw_nothing(author: Author, compiled: list[str]) -> None:
    author.save(BALLS)
    assert author.save("// said\n" + BALLS.replace("many = 3", "many   = 3.0")).speed is Speed.NOTHING
    assert author.save("// said\ndef unused = 1\n" + BALLS).speed is Speed.SAME_SHADER
    assert len(compiled) == 1


def test_a_live_number_stays_live_through_edits_beside_it(author: Author) -> None:
    author.save(BALLS)
    author.save(BALLS.replace("10deg", "12deg"))
    more = BALLS.replace("scene {", "scene {\n    sphere(0.1)")
    assert author.save(more.replace("10deg", "12deg")).live == 1
    assert author.save(more.replace("10deg", "14deg")).speed is Speed.NUMBERS


def test_a_name_of_ours_in_the_scene_is_no_clash(authors: Callable[[], Author]) -> None:
    text = "param literal_1 = 0.3 in 0.1..0.6\n" + BALLS.replace("[size,", "[literal_1,")
    one, other = authors(), authors()
    one.save(text)
    one.save(text.replace("0.25", "0.3"))
    assert one.save(text.replace("0.25", "0.35")).speed is Speed.NUMBERS
    other.save(text.replace("0.25", "0.35"))
    assert is_alike(one.picture, other.picture)


def test_a_broken_scene_leaves_everything_as_it_was(author: Author) -> None:
    author.save(BALLS)
    author.save(BALLS.replace("10deg", "12deg"))
    before = author.picture.read_bytes()
    with pytest.raises(SceneError):
        author.save(BALLS.replace("10deg", "14deg").replace("sphere", "spere"))
    assert author.picture.read_bytes() == before
    assert author.save(BALLS.replace("10deg", "14deg")).speed is Speed.NUMBERS


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The fragment shaders that the driver was given, as they come."""
    given: list[str] = []
    make = FragmentProgram.__init__

    def init(self: FragmentProgram, device: object, fragment: str, *rest: str) -> None:
        given.append(fragment)
        make(self, device, fragment, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(FragmentProgram, "__init__", init)
    return given
