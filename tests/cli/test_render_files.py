"""Rendering to files."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result

Run = Callable[..., Result]

SMALL = ("--size", "48x32")


@pytest.mark.gpu
def test_a_picture_and_its_images_beside_it(run: Run, tmp_path: Path, opengl: None) -> None:
    result = run("render", "s.sdf", "-o", "out.png", *SMALL, "--aov", "depth,normal,position,material,steps")
    assert result.output == ""
    assert result.exit_code == 0
    names = ["depth", "material", "normal", "position", "steps"]
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([*(f"out.{n}.npy" for n in names), "out.png", "s.sdf"])
    assert struct.unpack(">II", (tmp_path / "out.png").read_bytes()[16:24]) == (48, 32)
    depth, normal, position, material, steps = (
        np.load(tmp_path / f"out.{n}.npy") for n in ("depth", "normal", "position", "material", "steps")
    )
    assert depth.dtype == np.float32 and depth.shape == (32, 48)
    hit = np.isfinite(depth)
    assert hit[16, 24] and not hit[0, 0]
    assert depth[16, 24] == pytest.approx(3.5, abs=6e-3)
    np.testing.assert_allclose(np.linalg.norm(position[hit], axis=1), 0.5, atol=1e-5)
    np.testing.assert_allclose(normal[hit], position[hit] * 2.0, atol=1e-4)
    assert np.isnan(position[~hit]).all() and (normal[~hit] == 0.0).all()
    assert (material[hit] == 0).all() and (material[~hit] == -1).all()
    assert steps.dtype == np.int32 and (steps >= 0).all()


@pytest.mark.gpu
def test_rows_come_from_the_top(run: Run, tmp_path: Path, opengl: None) -> None:
    scene = "camera { eye: [0, 0, 4], target: [0, 0, 0], fov: 40deg }\nscene { sphere(0.3).translate([0, 1, 0]) }\n"
    assert run("render", "-", "-o", "up.exr", *SMALL, "--aov", "depth", stdin=scene).exit_code == 0
    hit_rows = np.flatnonzero(np.isfinite(np.load(tmp_path / "up.depth.npy")).any(axis=1))
    assert hit_rows.size and hit_rows.max() < 16


@pytest.mark.gpu
@pytest.mark.parametrize("file_format", ["npy", "exr", "png"])
def test_every_format_of_images(run: Run, tmp_path: Path, opengl: None, file_format: str) -> None:
    arguments = ("--aov", "depth,normal,position,material,steps", "--aov-format", file_format)
    assert run("render", "s.sdf", "-o", f"o.{file_format}", *SMALL, *arguments).exit_code == 0
    assert len(list(tmp_path.glob(f"o*.{file_format}"))) == 6


@pytest.mark.gpu
def test_params_and_cameras_change_the_picture(run: Run, tmp_path: Path, opengl: None) -> None:
    def hits(*arguments: str) -> int:
        assert run("render", "s.sdf", "-o", "a.png", *SMALL, "--aov", "depth", *arguments).exit_code == 0
        return int(np.isfinite(np.load(tmp_path / "a.depth.npy")).sum())

    plain = hits()
    assert hits("--set", "radius=0.25") < plain / 3
    assert hits("--set", "turn=45deg") == plain
    assert hits("--camera", "eye=0,0,8") < plain / 2
    assert hits("--camera", "height=1") > 2 * plain
    assert hits("--camera", "fov=80deg") < plain / 2
    assert hits("--tracer", "sphere") == pytest.approx(plain, rel=0.05)


@pytest.mark.gpu
def test_samples_smooth_the_edge_and_keep_the_middle(run: Run, tmp_path: Path, opengl: None) -> None:
    from sdfc.api import compile

    with compile(tmp_path / "s.sdf") as program:
        one = program.render((48, 32), aovs=()).colour
        many = program.render((48, 32), samples=16, aovs=()).colour
    assert len(np.unique(many.round(4))) > len(np.unique(one.round(4)))
    assert abs(many - one).max() > 0.05
    assert abs(many - one)[14:18, 22:26].max() < 0.02


@pytest.mark.gpu
def test_json_tells_what_was_written(run: Run, opengl: None) -> None:
    told = json.loads(run("render", "s.sdf", "-o", "a.png", *SMALL, "--aov", "depth", "--json").stdout)
    assert told["files"] == ["a.png", "a.depth.npy"]
    assert told["size"] == [48, 32]
    assert told["materials"] == ["red"]
    assert told["seconds"] > 0


@pytest.mark.gpu
def test_a_picture_on_standard_output(run: Run, opengl: None) -> None:
    result = run("render", "s.sdf", "-o", "-", *SMALL)
    assert result.stdout_bytes.startswith(b"\x89PNG") and result.stdout_bytes.endswith(b"IEND\xaeB`\x82")


def test_no_device_is_exit_3_and_nothing_is_written(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sdfc.gpu.device._EGL_LIBRARIES", ({"libgl": "libNone.so", "libegl": "libNone.so"},))
    result = run("render", "s.sdf", "-o", "a.png", *SMALL, "--backend", "gl")
    assert result.exit_code == 3
    assert "apt-get install" in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["s.sdf"]


@pytest.mark.gpu
def test_refused_glsl_is_our_bug(run: Run, monkeypatch: pytest.MonkeyPatch, opengl: None) -> None:
    monkeypatch.setattr("sdfc.pipeline.Compiled.glsl", lambda *_: "#version 450\nvoid main() { oops }\n")
    result = run("render", "s.sdf", "-o", "a.png", *SMALL, "--backend", "gl")
    assert result.exit_code == 70
    assert ">    2 | void main() { oops }" in result.stderr


@pytest.mark.gpu
def test_a_frame_left_undrawn_is_the_devices_failure(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, opengl: None
) -> None:
    monkeypatch.setattr("sdfc.gpu.program.FragmentProgram.draw", lambda self: None)
    result = run("render", "s.sdf", "-o", "a.png", *SMALL, "--backend", "gl")
    assert result.exit_code == 3
    assert "left pixels undrawn" in result.stderr
    assert not (tmp_path / "a.png").exists()
