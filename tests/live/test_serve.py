"""What pages are told of edits is what they need to draw them, and what they ask for is drawn."""

from __future__ import annotations

import itertools
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from author import BALLS, SIZE
from visitor import PATIENCE, Visitor, visitors

from sdfc.diagnostics import SceneError, show_all
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.image.write import OutputError
from sdfc.live.pages import Pages
from sdfc.live.saves import Bell
from sdfc.live.session import Session
from sdfc.live.snapshot import take
from sdfc.live.update import Speed, Update
from sdfc.pipeline import Compiled, load
from sdfc.shape.lower import lower

ROOT = Path(__file__).parents[2]
SCENES = ["csg5", "die", "blobs", "column", "lamp", "spheres"]
CAMERA_UNIFORMS = {"eye", "axis_x", "axis_y", "axis_z", "window", "pixel"}


class Host:
    """Somebody who edits a scene that pages show."""

    def __init__(self, folder: Path, picture: Path | None) -> None:
        self.bell = Bell()
        self.asked = threading.Semaphore(0)
        self.pages = Pages(0, self.asked.release)
        self.port = int(self.pages.address.rstrip("/").rsplit(":", 1)[1])
        self.scene = folder / "s.sdf"
        self.session = Session(picture, SIZE, "auto", "gl", print, self.pages, bell=self.bell)

    def save(self, text: str) -> Update:
        """As the watch does it."""
        self.scene.write_text(text)
        try:
            update = self.session.update(take(self.scene))
        except SceneError as error:
            self.pages.tell_errors(show_all(error.diagnostics), error)
            self.pages.tell("broken")
            raise
        self.pages.tell(update.speed.value)
        return update

    def answers(self) -> None:
        """One wish that was made, or is being made."""
        until = time.monotonic() + PATIENCE
        while not self.session.answer():
            assert self.asked.acquire(timeout=until - time.monotonic())

    def close(self) -> None:
        self.pages.close()
        self.session.close()


@pytest.fixture
def hosts(tmp_path: Path) -> Iterator[Callable[[Path | None], Host]]:
    made: list[Host] = []

    def host(picture: Path | None) -> Host:
        made.append(Host(tmp_path, picture))
        return made[-1]

    yield host
    for host_ in made:
        host_.close()


@pytest.fixture
def host(hosts: Callable[[Path | None], Host]) -> Host:
    return hosts(None)


@pytest.fixture
def visitor(host: Host) -> Iterator[Callable[[], Visitor]]:
    with visitors(host.port, host.session.greet) as made:
        yield made


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


def test_shaders_for_pages_are_printed_where_there_are_pages(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    printed: list[str] = []
    web = Compiled.web

    def counted(self: Compiled, entry: str) -> str:
        printed.append(entry)
        return web(self, entry)

    monkeypatch.setattr(Compiled, "web", counted)
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


@pytest.mark.gpu
def test_the_servers_picture_is_that_of_the_file(
    opengl: None, hosts: Callable[[Path | None], Host], tmp_path: Path
) -> None:
    host = hosts(tmp_path / "o.png")
    text = BALLS
    with visitors(host.port, host.session.greet) as visitor:
        for edit in ("0.3", "0.35", "0.28"):
            text = BALLS.replace("0.25", edit)
            host.save(text)
        page = visitor()
        told = page.hears("scene")
        page.asks(1, camera=told["camera"], size=list(SIZE))
        host.answers()
        first = page.picture(1)
        assert first == (tmp_path / "o.png").read_bytes()
        page.asks(2, camera=told["camera"], size=list(SIZE), params={"size": [0.9]})
        host.answers()
        host.save(text.replace("size = 0.5", "size = 0.9"))
        assert page.picture(2) == (tmp_path / "o.png").read_bytes() != first, "a param is as if it were in the file"
        page.until_note()
        camera = {**told["camera"], "eye": [2, 1, 3], "fov": None, "height": 3.0}
        page.asks(3, camera=camera, size=list(SIZE), params={"size": [0.5]})
        host.answers()
        assert page.picture(3) != first


@pytest.mark.gpu
def test_the_newest_wish_of_each_page_is_drawn_once(opengl: None, host: Host, visitor: Callable[[], Visitor]) -> None:
    host.save(BALLS)
    pages = [visitor() for _ in range(3)]
    scenes = [page.hears("scene") for page in pages]
    while host.asked.acquire(blocking=False):
        pass  # by who was not told the scene at once
    for request in range(4):
        for page in pages:
            page.asks(request, camera=scenes[0]["camera"])
    for _ in range(12):
        assert host.asked.acquire(timeout=PATIENCE)
    assert [host.session.answer() for _ in range(4)] == [True, True, True, False]
    assert len({page.picture(3) for page in pages}) == 1


@pytest.mark.gpu
def test_what_a_page_asked_for_waits_for_what_is_needed_first(
    opengl: None, host: Host, visitor: Callable[[], Visitor]
) -> None:
    host.save(BALLS)
    page = visitor()
    camera = page.hears("scene")["camera"]
    page.asks(1, camera=camera, size=[640, 360])
    assert host.asked.acquire(timeout=PATIENCE) and host.asked.acquire(timeout=PATIENCE)
    looks = iter([False, True])
    assert host.session.answer(lambda: next(looks)), "there is something to go on with"
    assert host.session.answer()
    page.picture(1)


@pytest.mark.gpu
def test_for_a_page_that_leaves_nothing_is_drawn_any_more(
    opengl: None, host: Host, visitor: Callable[[], Visitor]
) -> None:
    host.save(BALLS)
    alone = threading.active_count()
    page = visitor()
    page.asks(1, camera=page.hears("scene")["camera"], size=[1920, 1920])
    assert host.asked.acquire(timeout=PATIENCE) and host.asked.acquire(timeout=PATIENCE)
    looks: list[int] = []

    def look() -> bool:
        looks.append(len(looks))
        page.connection.close()
        while threading.active_count() > alone:
            time.sleep(0.01)
        return False

    assert host.session.answer(look) and not host.session.answer()
    assert len(looks) == 1


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("wish", "words"),
    [
        ({"params": {"nonsense": [1]}}, "no param 'nonsense'"),
        ({"params": {"literal_1": [0.3]}}, "no param 'literal_1'"),
        ({"params": {"size": [2]}}, "outside its range"),
        ({"params": {"size": [0.3, 0.3]}}, "takes a number"),
        ({"camera": {"fov": 4.0}}, "fov must be between"),
        ({"camera": {"eye": [0, 0, 0]}}, "are the same point"),
        ({"camera": {"up": [0, 0, 0]}}, "up direction is zero"),
        ({"camera": {"fov": None, "height": 0}}, "height must be above zero"),
        ({"camera": {"fov": None, "height": None}}, "either a fov or a height"),
        ({"camera": {"fov": 0.6, "height": 2}}, "either a fov or a height"),
    ],
)
def test_what_the_scene_does_not_have_is_refused_and_the_page_stays(
    opengl: None, host: Host, visitor: Callable[[], Visitor], wish: dict[str, dict[str, Any]], words: str
) -> None:
    host.save(BALLS)
    host.save(BALLS.replace("0.25", "0.3"))
    page = visitor()
    camera = page.hears("scene")["camera"]
    page.asks(7, params=wish.get("params", {}), camera=camera | wish.get("camera", {}))
    host.answers()
    refused = page.hears("refused")
    assert refused["request"] == 7 and words in refused["text"]
    page.asks(8, camera=camera)
    host.answers()
    page.picture(8)


def test_a_wish_before_there_is_a_scene_is_refused(host: Host, visitor: Callable[[], Visitor]) -> None:
    page = visitor()
    page.asks(1, camera={"eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 0.6, "height": None})
    host.answers()
    assert page.hears("refused")["text"] == "there is no picture of the scene yet"


@pytest.mark.gpu
def test_pages_go_on_where_the_file_cannot_be_written(
    opengl: None, hosts: Callable[[Path | None], Host], tmp_path: Path
) -> None:
    """What the file does not show, the pages may: each is told of what it has not seen."""
    folder = tmp_path / "pictures"
    folder.mkdir()
    host = hosts(folder / "o.png")
    host.save(BALLS)
    with visitors(host.port, host.session.greet) as visitor:
        page = visitor()
        before = page.hears("scene")
        (folder / "o.png").unlink()
        folder.rmdir()
        text = BALLS.replace("many = 3", "many = 2")
        with pytest.raises(OutputError):
            host.save(text)
        now = page.hears("scene")
        assert now["id"] == before["id"] + 1
        folder.mkdir()
        host.save(text.replace("eye: [0, 1, 4]", "eye: [1, 1, 4]"))
        last = page.hears("scene")
        assert (last["camera"]["eye"], last["shaders"]) == ([1, 1, 4], now["shaders"])
        assert (folder / "o.png").exists()
