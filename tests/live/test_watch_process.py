"""`sdfc watch` as a process: whoever saves, however, sees the picture follow."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from watching import PATIENCE, Watching

pytestmark = pytest.mark.gpu
SCENE = """\
import "part.sdf"
camera { eye: [0, 1, 4], target: [0, 0, 0], fov: 40deg }
light sun { direction: [-1, -2, -1] }
scene { ball(0.5) | instances("t.csv", sphere(radius: row.r).translate([row.x, 0, 0])) }
"""


@pytest.fixture
def folder(opengl: None, tmp_path: Path) -> Path:
    (tmp_path / "s.sdf").write_text(SCENE)
    (tmp_path / "part.sdf").write_text("def ball(r) = sphere(radius: r)\n")
    (tmp_path / "t.csv").write_text("r, x\n0.2, -1\n0.2, 1\n")
    return tmp_path


@pytest.fixture
def watching(folder: Path) -> Iterator[Watching]:
    with Watching(folder) as made:
        yield made


def in_place(path: Path, text: str) -> None:
    path.write_text(text)


def renamed_over(path: Path, text: str) -> None:
    other = path.with_name("~" + path.name)
    other.write_text(text)
    os.replace(other, path)


def moved_away_first(path: Path, text: str) -> None:
    """As vim does: the old file becomes a backup, the new one is written in several pieces, the backup is removed."""
    backup = path.with_name(path.name + "~")
    path.rename(backup)
    with path.open("w") as file:
        for start in range(0, len(text), 40):
            file.write(text[start : start + 40])
            file.flush()
    backup.unlink()


def test_the_same_text_saved_again_gets_the_picture_that_could_not_be_written(watching: Watching) -> None:
    watching.hears("new shader: ")
    picture = watching.folder / "o.png"
    picture.unlink()
    picture.mkdir()  # in whose place no file can be put
    scene = watching.folder / "s.sdf"
    scene.write_text(SCENE.replace("0.5", "0.6"))
    watching.hears("the last picture stays")
    picture.rmdir()
    scene.write_text(SCENE.replace("0.5", "0.6"))
    watching.hears("1 live number")
    assert watching.picture().startswith(b"\x89PNG")


SAVES = [in_place, renamed_over, moved_away_first]


def test_every_save_is_seen(watching: Watching) -> None:
    scene = watching.folder / "s.sdf"
    watching.hears("new shader: ")
    pictures = [watching.picture()]
    for size, save in enumerate([*SAVES, *SAVES], start=51):
        save(scene, SCENE.replace("0.5", f"0.{size}"))
        line = watching.hears("1 live number")
        assert ("numbers: " in line) == (size > 51), line
        pictures.append(watching.picture())
    assert len(set(pictures)) == len(pictures)
    assert not [line for line in watching.all if "error" in line]


def test_imports_and_tables_are_seen_and_errors_leave_the_picture(watching: Watching) -> None:
    folder = watching.folder
    watching.hears("new shader: ")
    pictures = [watching.picture()]
    for name, text in [
        ("part.sdf", "def ball(r) = box(size: [r, r, r])\n"),
        ("t.csv", "r, x\n0.2, -1\n0.3, 1\n0.1, 0\n"),
    ]:
        renamed_over(folder / name, text)
        watching.hears("new shader: ")
        pictures.append(watching.picture())
    assert len(set(pictures)) == 3
    in_place(folder / "part.sdf", "def ball(r) = spere(radius: r)\n")
    watching.hears("the last picture stays")
    watching.hears("part.sdf:1:15: error: unknown")
    watching.hears("^^^^^ did you mean 'sphere'?")
    (folder / "t.csv").unlink()
    watching.hears("error: the file 't.csv' does not exist")
    assert watching.picture() == pictures[-1]
    in_place(folder / "part.sdf", "def ball(r) = sphere(radius: r)\n")
    watching.hears("error: the file 't.csv' does not exist")
    in_place(folder / "t.csv", "r, x\n0.2, -1\n0.2, 1\n")
    watching.hears(" shader: ")
    assert watching.picture() == pictures[0]


def test_it_begins_with_a_broken_scene_and_needs_no_restart(folder: Path) -> None:
    (folder / "s.sdf").write_text(SCENE.replace("part.sdf", "new/part.sdf"))
    with Watching(folder) as watching:
        watching.hears("error: the file 'new/part.sdf' does not exist")
        assert not (folder / "o.png").exists()
        (folder / "new").mkdir()
        in_place(folder / "new" / "part.sdf", "def ball(r) = sphere(radius: r)\n")
        watching.hears("new shader: ")
        (folder / "s.sdf").rename(folder / "away")
        watching.hears("cannot read 's.sdf'")
        (folder / "away").rename(folder / "s.sdf")
        watching.hears("nothing to draw")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_it_ends_when_asked_and_leaves_nothing(watching: Watching, number: signal.Signals, code: int) -> None:
    watching.hears("new shader: ")
    assert watching.ends(number) == code
    assert not [line for line in watching.all if "Traceback" in line]
    assert sorted(os.listdir(watching.folder)) == ["o.png", "part.sdf", "s.sdf", "t.csv"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.sdf", "-o", "o.png"], "cannot read 'none.sdf'"),
        (["-", "-o", "o.png"], "standard input cannot be watched"),
        (["s.sdf", "-o", "-"], "give -o a name"),
        (["s.sdf", "-o", "nowhere/o.png"], "there is no folder 'nowhere'"),
        (["s.sdf", "-o", "o.png", "--tracer", "nonsense"], "there is no tracer 'nonsense'"),
        (["s.sdf", "-o", "o.png", "--size", "0x5"], "nothing in it"),
    ],
)
def test_what_cannot_be_is_said_at_once(folder: Path, arguments: list[str], words: str) -> None:
    command = [sys.executable, "-m", "sdfc", "watch", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr
