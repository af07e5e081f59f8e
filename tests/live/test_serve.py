"""What pages are told of edits is what they need to draw them."""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from author import BALLS
from host import Host
from visitor import PATIENCE, Visitor, head, reply, visitors

from sdfc.diagnostics import SceneError, show_all
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.live.snapshot import take
from sdfc.live.update import Speed
from sdfc.pipeline import Compiled, load
from sdfc.shape.lower import lower

ROOT = Path(__file__).parents[2]
SCENES = ["csg5", "die", "blobs", "column", "lamp", "spheres"]
CAMERA_UNIFORMS = {"eye", "axis_x", "axis_y", "axis_z", "window", "pixel"}


def declared(shader: str) -> set[str]:
    return set(re.findall(r"^uniform \w+ (\w+);", shader, re.MULTILINE))


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_all_that_its_shaders_ask_for(host: Host, visitor: Callable[[], Visitor], name: str) -> None:
    for table in (ROOT / "scenes").glob("*.csv"):
        host.scene.with_name(table.name).write_text(table.read_text())
    host.save((ROOT / "scenes" / f"{name}.sdf").read_text())
    told = visitor().hears("scene")
    assert declared(told["shaders"]["picture"]) <= CAMERA_UNIFORMS | told["values"].keys()
    assert declared(told["shaders"]["inspect"]) <= CAMERA_UNIFORMS | told["values"].keys() | {"shown"}
    assert all(text.startswith("#version 300 es\n") for text in told["shaders"].values())
    by_uniform = {param["uniform"]: param for param in told["params"]}
    assert by_uniform.keys() == told["values"].keys(), "nothing is live that nobody declared"
    for uniform, param in by_uniform.items():
        assert param["default"] == told["values"][uniform]
        assert len(param["default"]) == {"float": 1, "vec2": 2, "vec3": 3, "vec4": 4}[param["type"]]
        assert all(param["low"] <= number <= param["high"] for number in param["default"])
    camera = told["camera"]
    assert (camera["fov"] is None) != (camera["height"] is None)
    assert told["live"] == 0 and told["title"] == "s.sdf" and told["materials"]


@pytest.mark.parametrize("name", SCENES)
def test_what_is_solid_lies_in_the_boxes(host: Host, visitor: Callable[[], Visitor], name: str) -> None:
    """Of random points in and around the scene's box. All parts' boxes together hold it too."""
    for table in (ROOT / "scenes").glob("*.csv"):
        host.scene.with_name(table.name).write_text(table.read_text())
    text = (ROOT / "scenes" / f"{name}.sdf").read_text()
    host.save(text)
    told = visitor().hears("scene")
    low, high = np.array(told["bounds"]["low"]), np.array(told["bounds"]["high"])
    margin = 0.3 * (high - low)
    points = np.random.default_rng(4).uniform(low - margin, high + margin, (4000, 3))
    given = take(host.scene).given
    scene = load(given.source, given.folder, given.kind)
    field = lower(scene.root, scene.values.input("p", Type.VEC3))
    (depths,) = Evaluator([field])({"p": points.T}, {p.name: p.default for p in scene.params})
    solid = points[depths < -1e-9]
    assert len(solid) > 50
    if told["bounds"]["holds_everything"]:
        assert ((solid >= low) & (solid <= high)).all()
        held = [((solid >= part["low"]) & (solid <= part["high"])).all(axis=1) for part in told["parts"]]
        assert len(held) == 400 or np.any(held, axis=0).all()


def test_parts_are_called_by_what_they_are_and_where_they_are_written(
    host: Host, visitor: Callable[[], Visitor]
) -> None:
    host.save(BALLS)
    parts = visitor().hears("scene")["parts"]
    names = [part["name"] for part in parts]
    assert names == ["sphere, s.sdf:8"] * 3 + ["box, s.sdf:9", "bump, s.sdf:10"]
    assert np.allclose([parts[0]["low"], parts[0]["high"]], [[-0.95, -0.25, -0.25], [-0.45, 0.25, 0.25]])


def test_each_kind_of_edit_is_told_in_no_more_than_it_needs(host: Host, visitor: Callable[[], Visitor]) -> None:
    def told(text: str) -> list[dict[str, Any]]:
        host.save(text)
        return page.until_note()

    host.save(BALLS)
    page = visitor()
    first = page.hears("scene")
    (touched,) = told(BALLS.replace("0.25", "0.3"))
    assert (touched["type"], touched["id"], touched["live"]) == ("scene", first["id"] + 1, 1)
    assert set(touched["values"]) == {"set_size", "set_literal_1"}
    assert [param["name"] for param in touched["params"]] == ["size"], "a live literal is no control"
    text = BALLS.replace("0.25", "0.35")
    values, boxes = told(text)
    assert values == {"type": "values", "id": touched["id"], "values": {"set_literal_1": [0.35]}}
    assert (boxes["type"], boxes["id"]) == ("boxes", touched["id"])
    assert np.allclose(boxes["parts"][1]["high"], [0.35] * 3), "where it is now, not where it might be"
    text = text.replace("size = 0.5", "size = 0.8")
    assert told(text) == [{"type": "values", "id": touched["id"], "values": {"set_size": [0.8]}}]
    text = text.replace("eye: [0, 1, 4]", "eye: [1, 1, 4]")
    (moved,) = told(text)
    assert (moved["type"], moved["camera"]["eye"]) == ("camera", [1, 1, 4])
    assert told("// said\n" + text) == []
    (other,) = told(text.replace("many = 3", "many = 2"))
    assert (other["type"], other["id"]) == ("scene", touched["id"] + 1)


def test_what_is_broken_is_told_with_its_place_until_it_is_mended(host: Host, visitor: Callable[[], Visitor]) -> None:
    host.save(BALLS)
    page = visitor()
    page.hears("scene")
    with pytest.raises(SceneError) as caught:
        host.save(BALLS.replace("sphere", "spere"))
    (errors,) = page.until_note()
    assert errors["text"] == show_all(caught.value.diagnostics)
    assert "^^^^^ did you mean 'sphere'?" in errors["text"]
    (diagnostic,) = errors["diagnostics"]
    place = (diagnostic["file"], diagnostic["line"], diagnostic["hint"])
    assert place == (str(host.scene), 8, "did you mean 'sphere'?")
    assert BALLS.split("\n")[7][diagnostic["column"] - 1 :].startswith("sphere")
    late = visitor()
    assert (late.message()["type"], late.message()) == ("scene", errors)
    host.save(BALLS)
    assert page.until_note() == late.until_note() == [{"type": "well"}]
    with pytest.raises(SceneError):
        host.save(BALLS.replace("sphere", "spere"))
    host.save(BALLS.replace("size = 0.5", "size = 0.6"))
    assert [message["type"] for message in [*page.until_note(), *page.until_note()]] == ["errors", "values"]


def test_whoever_comes_late_is_told_what_the_others_were(host: Host, visitor: Callable[[], Visitor]) -> None:
    """All messages together are the scene that a new page gets."""
    edits = ["0.25", "0.3", "0.35", "0.32"]
    host.save(BALLS)
    page = visitor()
    known = page.hears("scene")
    for index, edit in enumerate(edits):
        text = BALLS.replace("0.25", edit).replace("size = 0.5", f"size = 0.{index + 3}")
        host.save(text.replace("eye: [0, 1, 4]", f"eye: [{index}, 1, 4]"))
        for message in page.until_note():
            match message.pop("type"):
                case "scene":
                    known = {**message, "type": "scene"}
                case "values":
                    known["values"].update(message["values"])
                    for param in known["params"]:
                        param["default"] = known["values"][param["uniform"]]
                case _:
                    known.update(message)
        assert visitor().hears("scene") == known


@pytest.fixture
def printed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The shaders for pages that were printed, as they come."""
    made: list[str] = []
    web = Compiled.web

    def counted(self: Compiled, entry: str) -> str:
        made.append(entry)
        return web(self, entry)

    monkeypatch.setattr(Compiled, "web", counted)
    return made


def test_shaders_for_pages_are_printed_where_there_are_pages(host: Host, printed: list[str]) -> None:
    host.save(BALLS)
    for number in ("0.3", "0.35"):
        host.save(BALLS.replace("0.25", number))
    with pytest.raises(SceneError):
        host.save(BALLS.replace("sphere", "spere"))
    assert printed == []
    with visitors(host.port, host.session.greet) as visitor:
        one, other = visitor(), visitor()
        first = one.hears("scene")
        assert first == other.hears("scene")
        assert one.message() == other.message() and first["values"]["set_literal_1"] == [0.35]
        assert printed == ["picture", "inspect"], "for the one and for the other"
        host.save(BALLS.replace("many = 3", "many = 2"))
        assert one.hears("scene")["id"] == first["id"] + 1
        assert len(printed) == 4
    until = time.monotonic() + PATIENCE
    texts = itertools.cycle(BALLS.replace("many = 3", f"many = {number}") for number in (4, 5))
    while printed:  # till the last of them has left
        assert time.monotonic() < until
        printed.clear()
        host.save(next(texts))


def test_they_are_printed_while_the_page_is_loaded(host: Host, printed: list[str]) -> None:
    host.save(BALLS)
    assert reply(host.port, head(host.port, "/page.js"))[0] == 200
    host.session.greet()
    assert printed == [], "a page begins with another file"
    assert reply(host.port, head(host.port, "/"))[0] == 200
    assert host.asked.acquire(timeout=PATIENCE)
    host.session.greet()
    assert printed == ["picture", "inspect"]
    with visitors(host.port) as visitor:
        visitor().hears("scene")


def test_a_page_that_comes_before_any_scene_waits_for_it(host: Host, visitor: Callable[[], Visitor]) -> None:
    with pytest.raises(SceneError):
        host.save("scene {")
    page = visitor()
    page.hears("errors")
    host.save(BALLS)
    page.hears("scene")


def test_without_a_camera_the_viewer_is_left_where_they_are(host: Host, visitor: Callable[[], Visitor]) -> None:
    """The camera that frames the scene follows each number; who comes late starts from there."""
    text = "scene { sphere(radius: 0.5) }\n"
    host.save(text)
    page = visitor()
    page.hears("scene")
    host.save(text.replace("0.5", "0.6"))
    assert [message["type"] for message in page.until_note()] == ["scene"]
    host.save(text.replace("0.5", "0.8"))
    assert [message["type"] for message in page.until_note()] == ["values", "boxes"]


def test_no_device_is_opened_where_nothing_is_drawn(
    host: Host, visitor: Callable[[], Visitor], monkeypatch: pytest.MonkeyPatch
) -> None:
    def opened(*_: object) -> None:
        raise AssertionError("a device was opened")

    monkeypatch.setattr("sdfc.live.painter.open_renderer", opened)
    for text in (BALLS, BALLS.replace("0.25", "0.3"), BALLS.replace("many = 3", "many = 2")):
        assert host.save(text).speed is Speed.NEW_SHADER
