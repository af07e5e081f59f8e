"""Animations: sweeps, time, files, films. On the CPU, so that they run anywhere; once on OpenGL, where there is one."""

from __future__ import annotations

import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from hypothesis import given
from hypothesis import strategies as st

from sdfc.api import RequestError, Sweep, compile
from sdfc.api.animation import Timeline, motion_of, parse_change
from sdfc.api.program import Program

Run = Callable[..., Result]

ROOT = Path(__file__).parent.parent.parent
SMALL = ("--size", "24x16", "--backend", "cpu")
CLOCK = "param time = 0 in 0..1\nscene { box(size: [1, 2, 1]).translate([time, 0, 0]) }\n"
TWO = "param a = 0 in -3..3\nparam tone = [0, 0, 0] in 0..1\nscene { sphere(1).translate([a, 0, 0]) }\n"


@pytest.fixture
def two() -> Program:
    """A program with a number and a vector."""
    return compile(TWO)


@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(-50, 50), st.integers(2, 60))
def test_a_sweep_is_linear_and_has_its_ends(start: float, end: float, first: int, count: int) -> None:
    frames = range(first, first + count)
    motion = motion_of(compile(TWO).params, {"a": Sweep(start, end)}, Timeline(frames))
    values = [motion.values(frame)["a"][0] for frame in frames]
    assert (values[0], values[-1]) == (start, end)
    assert all(min(start, end) <= value <= max(start, end) for value in values)
    np.testing.assert_allclose(np.diff(values), (end - start) / (count - 1), atol=1e-12)


def test_a_looped_sweep_ends_one_step_before_its_end(two: Program) -> None:
    motion = motion_of(two.params, {"a": "0..3"}, Timeline(range(6), loop=True))
    np.testing.assert_allclose([motion.values(n)["a"][0] for n in range(6)], np.arange(6) / 2)


def test_vectors_are_swept_by_component(two: Program) -> None:
    motion = motion_of(two.params, {"tone": "0,1,0 .. [1,0,0.5]"}, Timeline(range(3)))
    assert motion.values(1)["tone"] == (0.5, 0.5, 0.25)


def test_time_is_frame_over_fps_unless_it_is_given() -> None:
    params = compile(CLOCK).params
    timeline = Timeline(range(5, 11), fps=10)
    assert [motion_of(params, {}, timeline).values(n)["time"][0] for n in (5, 10)] == [0.5, 1.0]
    assert [motion_of(params, {"time": "0..1"}, timeline).values(n)["time"][0] for n in (5, 10)] == [0.0, 1.0]
    with pytest.raises(RequestError, match=r"time' = 1.1 .* range, 0..1 \(at frame 11, with 10 frames a second\)"):
        motion_of(params, {}, Timeline(range(12), fps=10))


def test_one_frame_is_the_sweeps_start(two: Program) -> None:
    assert motion_of(two.params, {"a": "1..2"}, Timeline(range(7, 8))).values(7)["a"] == (1.0,)


def test_a_sweep_as_it_is_typed() -> None:
    swept = parse_change("-90deg..1rad")
    assert isinstance(swept, Sweep)
    assert [swept.start.numbers, swept.end.numbers] == [(-math.pi / 2,), (1.0,)]
    assert not isinstance(parse_change("0.5"), Sweep)


def test_frames_are_the_pictures_that_render_makes(two: Program) -> None:
    shares: list[float] = []
    images = list(
        two.frames(range(4), (24, 16), params={"a": Sweep(-1, 2)}, backend="cpu", skip={1}, progress=shares.append)
    )
    for image, value in zip(images, (-1.0, 1.0, 2.0), strict=True):
        alone = two.render((24, 16), params={"a": value}, backend="cpu", aovs=())
        np.testing.assert_array_equal(image.colour, alone.colour)
    assert shares == sorted(shares) and shares[-1] == pytest.approx(1.0)
    assert abs(images[0].colour - images[1].colour).max() > 0.01


@pytest.mark.gpu
def test_all_frames_are_one_compile_and_one_frame_buffer(
    opengl: None, two: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sdfc.gpu import frames
    from sdfc.gpu.frame import Frame
    from sdfc.gpu.program import FragmentProgram

    made: list[str] = []

    class CountedFrame(Frame):
        def __init__(self, *given: object) -> None:
            made.append("frame")
            super().__init__(*given)

        def release(self) -> None:
            made.append("released")
            super().release()

    begin = FragmentProgram.__init__

    def counted(self: FragmentProgram, *given: object) -> None:
        made.append("program")
        begin(self, *given)

    monkeypatch.setattr(frames, "Frame", CountedFrame)
    monkeypatch.setattr(FragmentProgram, "__init__", counted)
    images = list(two.frames(range(6), (24, 16), params={"a": "-1..1"}, backend="gl", samples=2))
    assert sorted(made) == ["frame", "program", "released"]
    alone = two.render((24, 16), params={"a": 1.0}, backend="gl", samples=2, aovs=())
    np.testing.assert_array_equal(images[-1].colour, alone.colour)


@pytest.mark.gpu
def test_an_animation_that_is_left_gives_its_device_back(opengl: None, two: Program) -> None:
    with two:
        images = two.frames(range(6), (24, 16), params={"a": "-1..1"}, backend="gl")
        next(images)
        assert next(images).size == (24, 16)
    images.close()


def test_a_picture_for_every_frame(run: Run, tmp_path: Path) -> None:
    arguments = ("--frames", "8..11", "--set", "radius=0.2..0.8", "-o", "out_%03d%%.npy", "--aov", "depth", *SMALL)
    told = json.loads(run("render", "s.sdf", *arguments, "--json").stdout)
    names = [f"out_{n:03d}%.{end}" for n in range(8, 12) for end in ("npy", "depth.npy")]
    assert told["files"] == names and (told["drawn"], told["kept"]) == (4, 0)
    assert sorted(p.name for p in tmp_path.glob("out*")) == sorted(names)
    hits = [int(np.isfinite(np.load(tmp_path / f"out_{n:03d}%.depth.npy")).sum()) for n in range(8, 12)]
    assert hits == sorted(hits) and hits[0] < hits[-1] / 4


def test_resuming_draws_what_is_missing_alone(run: Run, tmp_path: Path) -> None:
    arguments = ("render", "s.sdf", "--frames", "0..3", "--set", "radius=0.2..0.8", "-o", "o%d.png", *SMALL)
    assert run(*arguments).output == ""
    whole = {p.name: p.read_bytes() for p in tmp_path.glob("o*.png")}
    (tmp_path / "o2.png").unlink()
    (tmp_path / "o0.png").write_bytes(b"kept as it is")
    result = run(*arguments, "--resume", "--json")
    assert [json.loads(result.stdout)[key] for key in ("files", "drawn", "kept")] == [["o2.png"], 1, 3]
    assert (tmp_path / "o2.png").read_bytes() == whole["o2.png"]
    assert (tmp_path / "o0.png").read_bytes() == b"kept as it is"
    os.utime(tmp_path / "s.sdf", (time.time() + 60, time.time() + 60))
    assert run(*arguments, "--resume").stderr == "note: 4 of the 4 frames that are kept are older than s.sdf\n"
    assert run(*arguments).exit_code == 0
    assert (tmp_path / "o0.png").read_bytes() == whole["o0.png"], "without --resume all are drawn"


@pytest.mark.parametrize(("name", "start"), [("a.gif", b"GIF89a"), ("a.mp4", b"\0\0\0")])
def test_a_film(run: Run, tmp_path: Path, name: str, start: bytes) -> None:
    result = run("render", "s.sdf", "--frames", "0..3", "--set", "radius=0.2..0.8", "--loop", "-o", name, *SMALL)
    assert (result.exit_code, result.output) == (0, "")
    assert (tmp_path / name).read_bytes().startswith(start)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([name, "s.sdf"])


def test_frames_that_are_all_the_same_are_remarked_on(run: Run) -> None:
    assert "all frames are the same" in run("render", "s.sdf", "--frames", "0..1", "-o", "o%d.png", *SMALL).stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--set", "radius=0.2..0.8", "-o", "o.png"), "'radius' is swept from one value to another: say over which"),
        (("-o", "o.gif"), "'o.gif' would be a film: say over which frames"),
        (("--fps", "24", "-o", "o.png"), "--fps is for animations"),
        (("--frames", "0..3", "-o", "o.png"), "write it as in o_%04d.png"),
        (("--frames", "0..3", "-o", "o_%d_%d.png"), "write it as in o_%04d.png"),
        (("--frames", "0..3", "-o", "o_%s.png"), "write it as in o_%04d.png"),
        (("--frames", "0..3", "-o", "-"), "not written to standard output"),
        (("--frames", "3..0", "-o", "o%d.png"), "ends before it begins"),
        (("--frames", "many", "-o", "o%d.png"), "first and a last frame like 0..120"),
        (("--frames", "0..3", "--set", "radius=0.2..8", "-o", "o%d.png"), "outside its range, 0.1..1"),
        (("--frames", "0..3", "--set", "turn=0..1", "-o", "o%d.png"), "'turn' is an angle"),
        (("--frames", "0..3", "--set", "radius=..1", "-o", "o%d.png"), "not a sweep like"),
        (("--frames", "0..3", "--set", "raduis=0..1", "-o", "o%d.png"), "did you mean 'radius'"),
        (("--frames", "0..3", "--resume", "-o", "o.gif"), "--resume goes with a picture for every frame"),
        (("--frames", "0..3", "--aov", "depth", "-o", "o.gif"), "--aov goes with a picture for every frame"),
        (("--frames", "0..3", "--size", "25x16", "-o", "o.mp4"), "even width and height"),
        (("--frames", "0..3", "-o", "none/o%d.png"), "there is no folder"),
        (("--frames", "0..9999999", "-o", "o%d.png"), "between 1 and 1000000 frames"),
    ],
)
def test_what_makes_no_sense_is_said_before_anything_is_drawn(
    run: Run, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    result = run("render", "s.sdf", "--backend", "cpu", *arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())
    assert [p.name for p in tmp_path.iterdir()] == ["s.sdf"]


@pytest.mark.parametrize("name", ["out_%05d.png", "out.mp4"])
def test_stopped_it_leaves_whole_files_alone(run: Run, tmp_path: Path, name: str) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    command = [sys.executable, "-m", "sdfc", "render", "s.sdf", "--frames", "0..90000", "--set", "radius=0.2..0.8"]
    process = subprocess.Popen(
        [*command, "-o", name, *SMALL], stderr=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(temporary)}
    )
    deadline = time.monotonic() + 60
    while not (any(temporary.iterdir()) or list(tmp_path.glob("out_00002.png"))) and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=20)
    assert process.returncode == 130
    assert told.strip() == "interrupted"
    left = {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.name not in ("s.sdf", "temporary")}
    assert all(data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB`\x82") for data in left.values())
    assert bool(left) == ("%" in name), "half a film is no film"
    assert list(temporary.iterdir()) == []


def shown(language: str) -> list[str]:
    """The blocks of docs/animation.md in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / "docs" / "animation.md").read_text(), re.DOTALL | re.M)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the repository's scenes."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    return tmp_path


@pytest.mark.parametrize("line", "".join(shown("sh")).splitlines())
def test_the_commands_of_the_page(line: str, folder: Path) -> None:
    words = shlex.split(line, comments=True)
    done = subprocess.run([sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    first, last = map(int, words[words.index("--frames") + 1].split(".."))
    names = {words[-1] % n if "%" in words[-1] else words[-1] for n in range(first, last + 1)}
    assert {p.name for p in folder.iterdir() if p.is_file()} == names


def test_the_scene_of_the_page_moves() -> None:
    (text,) = shown("sdf")
    first, second = compile(text).frames(range(0, 20, 15), (24, 16), backend="cpu")
    assert abs(first.colour - second.colour).max() > 0.1


def test_the_python_of_the_page(folder: Path) -> None:
    (text,) = shown("python")
    done = subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert len(list(folder.glob("still_*.png"))) == 4
