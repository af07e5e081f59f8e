"""A scene's file, and sessions that draw it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from author import Author
from desk import Desk
from host import Host
from visitor import Visitor, visitors

from sdfc.live.snapshot import take


@pytest.fixture
def authors(opengl: None, tmp_path: Path) -> Iterator[Callable[[], Author]]:
    """Makes authors, each in a folder of its own."""
    made: list[Author] = []

    def author() -> Author:
        folder = tmp_path / str(len(made))
        folder.mkdir()
        made.append(Author(folder))
        return made[-1]

    yield author
    for author_ in made:
        author_.session.close()


@pytest.fixture
def author(authors: Callable[[], Author]) -> Author:
    return authors()


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


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    made = Desk(tmp_path)
    yield made
    made.session.close()


@pytest.fixture
def picture_of(tmp_path: Path) -> Iterator[Callable[[str], bytes]]:
    """What a session without a worker draws."""
    folder = tmp_path / "fresh"
    folder.mkdir()
    desk = Desk(folder)

    def drawn(text: str) -> bytes:
        desk.scene.write_text(text)
        desk.session.distrust()
        desk.session.update(take(desk.scene))
        return desk.picture()

    yield drawn
    desk.session.close()
