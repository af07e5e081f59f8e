"""While a shader is compiled elsewhere, what was there goes on; then the newest is shown, and nothing that is older."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest
from author import BALLS, OTHER, SIZE
from desk import Desk
from visitor import PATIENCE, Visitor, visitors

from sdfc.api.renderer import GlRenderer
from sdfc.diagnostics import DeviceError, SceneError
from sdfc.live.pages import Pages
from sdfc.live.session import Session
from sdfc.live.snapshot import take
from sdfc.live.update import Speed
from sdfc.live.worker import Outcome, Worker

pytestmark = [pytest.mark.gpu, pytest.mark.usefixtures("opengl")]

THIRD = BALLS.replace("many = 3", "many = 4")


def test_the_picture_stays_until_the_shader_is_there(desk: Desk, picture_of: Callable[[str], bytes]) -> None:
    first = desk.begins(BALLS)
    assert first is not None and first.speed is Speed.NEW_SHADER, "there was nothing to stay"
    before = desk.picture()
    assert desk.begins(OTHER) is None
    assert desk.session.go_on() is None and desk.picture() == before
    desk.worker.finishes()
    update = desk.session.go_on()
    assert update is not None and update.speed is Speed.NEW_SHADER and "compiling ahead" in update.times
    assert desk.picture() == picture_of(OTHER)
    assert desk.session.go_on() is None, "once"


def test_who_waits_is_woken(desk: Desk) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    assert not desk.bell.wait(0.0)
    desk.worker.finishes()
    assert desk.bell.wait(0.0)


@pytest.mark.parametrize("outcome", [Outcome.NOT_KEPT, Outcome.REFUSED, Outcome.LOST])
def test_whatever_becomes_of_the_worker_the_picture_comes(
    desk: Desk, picture_of: Callable[[str], bytes], outcome: Outcome
) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    desk.worker.helps = False
    desk.worker.finishes(outcome)
    assert desk.session.go_on() is not None
    assert desk.picture() == picture_of(OTHER)
    assert desk.begins(THIRD) is not None, "and the next is not asked for"
    assert len(desk.worker.jobs) == 1


def test_the_newest_wins(desk: Desk, picture_of: Callable[[str], bytes]) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    desk.begins(THIRD)
    (_, first), (_, second) = desk.worker.jobs
    assert first.cancelled() and not second.done()
    second.set_result(Outcome.KEPT)
    assert desk.session.go_on() is not None
    assert desk.picture() == picture_of(THIRD)


def test_numbers_are_changed_by_the_old_shader_meanwhile(desk: Desk, picture_of: Callable[[str], bytes]) -> None:
    """Whoever takes an edit of the structure back does not wait for its shader."""
    desk.begins(BALLS)
    desk.begins(OTHER)
    text = BALLS.replace("size = 0.5", "size = 0.8")
    update = desk.begins(text)
    assert update is not None and update.speed is Speed.NUMBERS
    desk.worker.finishes()
    assert desk.session.go_on() is None
    assert desk.picture() == picture_of(text)


def test_numbers_are_changed_of_what_waits(desk: Desk, picture_of: Callable[[str], bytes]) -> None:
    """It is compiled once, and shown as it is in the end."""
    desk.begins(BALLS)
    desk.begins(OTHER)
    for size in ("0.6", "0.7", "0.8"):
        assert desk.begins(OTHER.replace("size = 0.5", f"size = {size}")) is None
    assert desk.begins("// said\n" + OTHER.replace("size = 0.5", "size = 0.8")) is None
    assert len(desk.worker.jobs) == 1
    desk.worker.finishes()
    update = desk.session.go_on()
    assert update is not None and update.speed is Speed.NEW_SHADER
    assert desk.picture() == picture_of(OTHER.replace("size = 0.5", "size = 0.8"))
    again = desk.begins(OTHER.replace("size = 0.5", "size = 0.9"))
    assert again is not None and again.speed is Speed.NUMBERS


def test_what_is_broken_meanwhile_is_told_and_the_rest_goes_on(desk: Desk, picture_of: Callable[[str], bytes]) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    with pytest.raises(SceneError):
        desk.begins(OTHER + "}")
    desk.worker.finishes()
    assert desk.session.go_on() is not None
    assert desk.picture() == picture_of(OTHER)


def test_what_may_not_be_what_was_read_is_shown_and_not_built_upon(desk: Desk) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    desk.session.distrust()
    desk.worker.finishes()
    assert desk.session.go_on() is not None
    text = OTHER.replace("size = 0.5", "size = 0.8")
    update = desk.begins(text)
    assert update is not None and update.speed is Speed.SAME_SHADER, "compiled again, by sdfc"


def test_what_waits_and_may_not_be_what_was_read_is_not_built_upon(
    desk: Desk, picture_of: Callable[[str], bytes]
) -> None:
    """An import is other for as long as the compiler reads it, and then what it was."""
    part = desk.scene.with_name("part.sdf")
    there = "def many = 2\n"
    part.write_text(there)
    text = 'import "part.sdf"\n' + BALLS.replace("def many = 3\n", "")
    desk.scene.write_text(text)
    desk.begins(THIRD)
    desk.scene.write_text(text)
    seen = take(desk.scene)
    part.write_text("def many = 1\n")
    assert desk.session.begin(seen) is None
    desk.session.distrust()
    part.write_text(there)
    desk.session.begin(take(desk.scene))
    desk.worker.finishes()
    desk.session.go_on()
    assert desk.picture() == picture_of(OTHER)


def test_after_what_may_not_be_what_was_read_the_worker_compiles_as_ever(desk: Desk) -> None:
    desk.begins(BALLS)
    before = desk.picture()
    desk.session.distrust()
    assert desk.begins(OTHER) is None and len(desk.worker.jobs) == 1
    assert desk.picture() == before, "it stays until the shader is there"


@dataclass
class Served:
    """A desk with pages, and one who looks at them."""

    desk: Desk
    viewer: Visitor
    asked: threading.Semaphore

    def asks(self, request: int, camera: object) -> None:
        self.viewer.asks(request, camera=camera, size=list(SIZE))
        assert self.asked.acquire(timeout=PATIENCE)


@pytest.fixture
def serving(tmp_path: Path) -> Iterator[Callable[[bool], Served]]:
    """Makes a desk with pages; whether it has a file as well."""
    with ExitStack() as stack:

        def made(has_file: bool) -> Served:
            asked = threading.Semaphore(0)
            pages = Pages(0, asked.release)
            stack.callback(pages.close)
            desk = Desk(tmp_path, pages, has_file)
            stack.callback(desk.session.close)
            port = int(pages.address.rstrip("/").rsplit(":", 1)[1])
            visitor = stack.enter_context(visitors(port, desk.session.greet))
            assert (desk.begins(BALLS) is None) == has_file, "pages do not wait for the first picture"
            viewer = visitor()
            assert asked.acquire(timeout=PATIENCE), "to be told the scene"
            return Served(desk, viewer, asked)

        yield made


def test_a_page_is_drawn_for_when_the_shader_is_there(serving: Callable[[bool], Served]) -> None:
    served = serving(True)
    desk, viewer = served.desk, served.viewer
    first = viewer.hears("scene")
    served.asks(1, first["camera"])
    assert not desk.session.answer(), "its shader is compiled"
    desk.worker.finishes()
    desk.session.go_on()
    assert desk.session.answer()
    before = viewer.picture(1)
    desk.begins(OTHER)
    assert viewer.hears("scene")["id"] == first["id"] + 1, "the page compiles for itself"
    served.asks(2, first["camera"])
    assert not desk.session.answer()
    desk.worker.finishes()
    assert desk.session.answer(), "before the file is written, or after it"
    assert viewer.picture(2) != before
    assert desk.session.go_on() is not None


def test_what_a_page_waits_for_is_not_given_up_for_numbers(serving: Callable[[bool], Served]) -> None:
    served = serving(False)
    desk, viewer = served.desk, served.viewer
    camera = viewer.hears("scene")["camera"]
    assert not desk.worker.jobs, "nobody asked for a picture"
    served.asks(1, camera)
    assert not desk.session.answer()
    for size in ("0.6", "0.7"):
        update = desk.begins(BALLS.replace("size = 0.5", f"size = {size}"))
        assert update is not None and update.speed is Speed.NUMBERS
        viewer.hears("values")
        assert not desk.session.answer()
    ((_, future),) = desk.worker.jobs
    future.set_result(Outcome.KEPT)
    assert desk.session.answer()
    last = viewer.picture(1)
    desk.begins(BALLS.replace("size = 0.5", "size = 0.6"))
    viewer.hears("values")
    served.asks(2, camera)
    assert desk.session.answer()
    assert viewer.picture(2) != last, "it had the newest numbers"
    desk.begins(OTHER)
    viewer.hears("scene")
    served.asks(3, camera)
    assert not desk.session.answer()
    desk.begins(THIRD)
    viewer.hears("scene")
    assert desk.worker.jobs[1][1].cancelled(), "a scene that is gone is given up"
    assert not desk.session.answer()
    desk.worker.finishes()
    assert desk.session.answer()
    viewer.picture(3)


def test_a_compile_that_was_left_does_not_hold_up_what_waits_behind_it(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk.begins(BALLS)
    desk.begins(OTHER)
    desk.worker.jobs[0][1].set_running_or_notify_cancel()
    desk.begins(THIRD)
    assert desk.session.go_on() is None and desk.worker.stops == 0, "it may be done soon"
    monkeypatch.setattr("sdfc.live.painter._LONG", 0.0)
    assert desk.session.go_on() is None and desk.worker.stops == 1
    assert desk.session.go_on() is None and desk.worker.stops == 1, "once"


def test_a_device_that_fails_for_a_page_has_no_shader_any_more(
    serving: Callable[[bool], Served], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise DeviceError("gone")

    served = serving(True)
    desk, viewer = served.desk, served.viewer
    camera = viewer.hears("scene")["camera"]
    desk.worker.finishes()
    assert desk.session.go_on() is not None
    served.asks(1, camera)
    with monkeypatch.context() as patched:
        patched.setattr(GlRenderer, "radiance", fails)
        assert desk.session.answer()
    assert viewer.hears("refused")["text"] == "gone"
    assert desk.begins(f"def unused = 1\n{BALLS}") is None, "it is compiled again"
    desk.worker.finishes()
    update = desk.session.go_on()
    assert update is not None and update.speed is Speed.NEW_SHADER


def test_the_real_worker_makes_the_same_picture(tmp_path: Path, picture_of: Callable[[str], bytes]) -> None:
    with Worker(print) as worker:
        desk = Desk(tmp_path)
        session = Session(desk.file, SIZE, "auto", "gl", print, None, worker, desk.bell)
        for text in (BALLS, OTHER, THIRD):
            desk.scene.write_text(text)
            update = session.begin(take(desk.scene))
            while update is None:
                desk.bell.wait(30.0)
                update = session.go_on()
            assert desk.picture() == picture_of(text)
        session.close()
