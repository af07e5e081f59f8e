"""`sdfc watch --serve` as a process: a page follows every save, asks for pictures, and the end is quiet."""

from __future__ import annotations

import json
import random
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from author import BALLS, Author
from click.testing import CliRunner
from visitor import Visitor, head, reply, visitors
from watching import FILE, PATIENCE, Watching

from sdfc import page
from sdfc.api.request import RequestError
from sdfc.cli.verbs import command
from sdfc.image.picture import Image


def port_of(watching: Watching) -> int:
    line = watching.hears("serving")
    found = re.fullmatch(r"serving http://127\.0\.0\.1:(\d+)/", line)
    assert found is not None, line
    return int(found[1])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "s.sdf").write_text(BALLS)
    return tmp_path


@pytest.fixture
def watching(folder: Path) -> Iterator[Watching]:
    with Watching(folder, ("--serve", "0")) as made:
        yield made


def told(visitor: Visitor, kind: str) -> dict[str, Any]:
    """The next message of this kind: a machine that is busy may see one save as two, or two as one."""
    while (message := visitor.message())["type"] != kind:
        pass
    return message


def until(visitor: Visitor, is_it: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """The next message of which that is so; pictures are passed over."""
    while True:
        frame = visitor.connection.recv(timeout=PATIENCE)
        if isinstance(frame, str) and is_it(message := json.loads(frame)):
            assert isinstance(message, dict)
            return message


@pytest.mark.gpu
def test_a_page_follows_the_file_and_draws_from_anywhere(opengl: None, watching: Watching) -> None:
    port, scene = port_of(watching), watching.folder / "s.sdf"
    assert reply(port, head(port, "/"))[2] == page.content("index.html")
    watching.hears("new shader: ")
    with visitors(port) as visitor:
        viewer = visitor()
        first = told(viewer, "scene")
        scene.write_text(BALLS.replace("0.25", "0.3"))
        assert told(viewer, "scene")["live"] == 1
        assert "new shader: " in told(viewer, "note")["text"]
        scene.write_text(BALLS.replace("0.25", "0.35"))
        assert told(viewer, "values")["values"] == {"set_literal_1": [0.35]}
        scene.write_text(BALLS.replace("0.25", "0.35").replace("sphere", "spere"))
        assert "s.sdf:8:29: error: unknown" in told(viewer, "errors")["text"]
        assert told(viewer, "note")["text"].endswith("s.sdf: the last picture stays")
        watching.hears("^^^^^ did you mean 'sphere'?")
        viewer.asks(5, camera=first["camera"])
        told(viewer, "picture")
        assert isinstance(picture := viewer.connection.recv(timeout=PATIENCE), bytes)
        assert picture.startswith(b"\x89PNG")
        scene.write_text(BALLS.replace("0.25", "0.35"))
        told(viewer, "well")
        scene.write_text(BALLS.replace("0.25", "0.35").replace("eye: [0, 1, 4]", "eye: [0, 2, 4]"))
        assert told(viewer, "camera")["camera"]["eye"] == [0, 2, 4]
        assert watching.ends(signal.SIGINT) == 130


@pytest.mark.gpu
def test_the_file_and_the_page_follow_together(opengl: None, folder: Path) -> None:
    with Watching(folder, (*FILE, "--serve=0")) as watching, visitors(port_of(watching)) as visitor:
        watching.hears("new shader: ")
        viewer = visitor()
        camera = told(viewer, "scene")["camera"]
        (folder / "s.sdf").write_text(BALLS.replace("many = 3", "many = 2"))
        told(viewer, "scene")
        told(viewer, "note")
        viewer.asks(1, camera=camera)
        assert viewer.picture(1) == watching.picture()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_it_ends_when_asked_whoever_is_there(watching: Watching, number: signal.Signals, code: int) -> None:
    port = port_of(watching)
    watching.hears("new shader: ")
    with visitors(port) as visitor, socket.create_connection(("127.0.0.1", port)):
        visitor().hears("scene")
        assert watching.ends(number) == code
    assert not [line for line in watching.all if "Traceback" in line]
    assert [path.name for path in watching.folder.iterdir()] == ["s.sdf"]
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port))
    with Watching(watching.folder, ("--serve", str(port))) as again:
        assert port_of(again) == port, "at once"


def test_a_scene_that_is_broken_at_first_is_served_when_it_is_mended(folder: Path) -> None:
    (folder / "s.sdf").write_text("scene {")
    with Watching(folder, ("--serve", "0")) as watching, visitors(port_of(watching)) as visitor:
        watching.hears("error: ")
        viewer = visitor()
        assert "never closed" in told(viewer, "errors")["text"]
        (folder / "s.sdf").write_text(BALLS)
        assert told(viewer, "scene")["title"] == "s.sdf"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["s.sdf"], "give -o a file's name, or --serve"),
        (["s.sdf", "--serve", "65536"], "65536 is not in the range"),
        (["s.sdf", "--serve", "0", "--tracer", "nonsense"], "there is no tracer 'nonsense'"),
        (["none.sdf", "--serve", "0"], "cannot read 'none.sdf'"),
    ],
)
def test_what_cannot_be_is_said_at_once(folder: Path, arguments: list[str], words: str) -> None:
    done = run(folder, *arguments)
    assert done.returncode == 2
    assert words in done.stderr


@pytest.mark.parametrize(
    ("arguments", "port"),
    [
        (["--serve", "s.sdf"], 8642),
        (["s.sdf", "--serve"], 8642),
        (["--serve", "--size", "8x8", "s.sdf"], 8642),
        (["--serve", "0", "s.sdf"], 0),
        (["s.sdf", "--serve=9000"], 9000),
    ],
)
def test_a_scenes_name_is_no_port(
    folder: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], port: int
) -> None:
    asked: list[int] = []

    def taken(port: int, wanted: object) -> None:
        asked.append(port)
        raise RequestError("taken")

    monkeypatch.chdir(folder)
    monkeypatch.setattr("sdfc.live.pages.Pages", taken)
    done = CliRunner().invoke(command, ["watch", *arguments])
    assert (done.exit_code, asked) == (2, [port])


def test_a_port_that_is_taken_is_one_clear_error(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = run(folder, "s.sdf", "--serve", str(port))
    words = f"error: cannot serve on port {port} (Address already in use): give another, or 0 for any free one\n"
    assert (done.returncode, done.stdout, done.stderr) == (2, "", words)


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sdfc", "watch", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE)


@pytest.mark.gpu
def test_after_a_storm_of_saves_all_have_the_last_one(opengl: None, folder: Path, tmp_path_factory: Any) -> None:
    """Saves of all kinds, faster than they can be shown, while a page asks for pictures."""
    texts = [BALLS, BALLS.replace("many = 3", "many = 2"), BALLS.replace("round(0.02)", "round(0.05)"), BALLS + "}"]
    shuffled = random.Random(4)
    with Watching(folder, (*FILE, "--serve=0")) as watching, visitors(port_of(watching)) as visitor:
        viewer = visitor()
        camera = told(viewer, "scene")["camera"]
        for number in range(60):
            text = shuffled.choice(texts).replace("size = 0.5", f"size = 0.{shuffled.randrange(20, 90)}")
            (folder / "s.sdf").write_text(text)
            viewer.asks(number, camera=camera)
            time.sleep(shuffled.choice([0.0, 0.02, 0.05, 0.1]))
        last = texts[2].replace("size = 0.5", "size = 0.91").replace("0.25", "0.3")
        (folder / "s.sdf").write_text(last)
        until(viewer, lambda message: message.get("values", {}).get("set_size") == [0.91])
        until(viewer, lambda message: message["type"] == "note")
        viewer.asks(60, camera=camera)
        assert until(viewer, lambda message: message.get("request") == 60)["type"] == "picture"
        assert viewer.connection.recv(timeout=PATIENCE) == watching.picture()
        assert watching.ends(signal.SIGINT) == 130
    assert not [line for line in watching.all if "Traceback" in line or "bug" in line]
    fresh = Author(tmp_path_factory.mktemp("fresh"))
    fresh.save(last)
    wanted = Image(np.load(fresh.picture)).pixels.astype(int)
    fresh.session.close()
    with PIL.Image.open(folder / "o.png") as picture:
        assert (np.abs(np.asarray(picture).astype(int) - wanted).max(axis=-1) > 3).mean() < 0.01
