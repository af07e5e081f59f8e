"""The loop of the watch: no save and no ring of the bell is lost, and a save comes first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from author import BALLS, OTHER
from desk import Desk

from sdfc.live.saves import Saves
from sdfc.live.update import Speed, Update
from sdfc.live.watch import _watched, watch

pytestmark = [pytest.mark.gpu, pytest.mark.usefixtures("opengl")]


def test_a_save_is_seen_while_a_page_is_drawn_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And it is shown at once: the page's picture is begun again after it."""
    desk = Desk(tmp_path, None, has_file=False)
    desk.scene.write_text(BALLS)
    looks: list[bool] = []

    def answer(is_needed: Callable[[], bool]) -> bool:
        looks.append(is_needed())
        desk.scene.write_text(OTHER)
        looks.append(is_needed())
        return True

    monkeypatch.setattr(desk.session, "answer", answer)
    updates = watch(desk.scene, None, desk.session)
    for _ in range(2):
        update = next(updates)
        assert isinstance(update, Update) and update.speed is Speed.NEW_SHADER
    assert looks == [False, True]
    updates.close()  # type: ignore[attr-defined]


def test_a_save_during_the_first_look_is_seen(
    desk: Desk, picture_of: Callable[[str], bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    def watched(*given: Any) -> tuple[Path, ...]:
        paths = _watched(*given)
        desk.scene.write_text(OTHER)
        return paths

    desk.scene.write_text(BALLS)
    monkeypatch.setattr("sdfc.live.watch._watched", watched)
    updates = watch(desk.scene, None, desk.session)
    next(updates)
    updates.close()  # type: ignore[attr-defined]
    assert desk.picture() == picture_of(OTHER)


def test_who_rings_together_with_a_save_is_heard_after_it(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[float] = []

    def wait(_: Saves, seconds: float) -> bool:
        waits.append(seconds)
        return len(waits) == 1

    def answer(_: object) -> bool:
        raise AssertionError("asked for a picture")

    monkeypatch.setattr(Saves, "wait", wait)
    monkeypatch.setattr(desk.session, "answer", answer)
    desk.scene.write_text(BALLS)
    updates = watch(desk.scene, None, desk.session)
    next(updates)
    desk.scene.write_text(BALLS.replace("size = 0.5", "size = 0.6"))
    next(updates)
    with pytest.raises(AssertionError, match="asked for a picture"):
        next(updates)
    assert waits[1] == 0.0, "it does not wait for another ring"
