"""What pages ask for is drawn, in turns and after what is needed first; what nobody can draw is refused."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from author import BALLS, SIZE
from host import Host
from visitor import PATIENCE, Visitor, visitors

from sdfc.image.write import OutputError


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
