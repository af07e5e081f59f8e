"""`sdfc emit-glsl`: parts, targets, files, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result

Run = Callable[..., Result]


def test_a_part_is_named_after_the_scene_or_as_asked(run: Run) -> None:
    assert "float s_sdf(vec3 p)" in run("emit-glsl", "s.sdf", "--part", "field").stdout
    assert "my_hit my_trace(" in run("emit-glsl", "s.sdf", "--part", "tracer", "--prefix", "my_").stdout
    told = json.loads(run("emit-glsl", "s.sdf", "--part", "field", "--json").stdout)
    assert (told["part"], told["stage"]) == ("field", "fragment")
    assert "uniform float s_radius;" in told["text"]


def test_params_are_baked_at_what_is_set(run: Run) -> None:
    baked = run("emit-glsl", "s.sdf", "--bake", "--set", "radius=0.25", "--set", "turn=90deg", "--part", "field").stdout
    assert "const float s_radius = 0.25;" in baked
    assert "uniform" not in baked


def test_a_pair_of_stages_is_two_files(run: Run, tmp_path: Path) -> None:
    assert run("emit-glsl", "s.sdf", "--target", "raster", "-o", "ball").exit_code == 0
    assert (tmp_path / "ball.vert").read_text().startswith("#version 330 core")
    assert "gl_FragDepth" in (tmp_path / "ball.frag").read_text()
    told = json.loads(run("emit-glsl", "s.sdf", "--target", "raster", "-o", "b", "--json").stdout)
    assert told["files"] == ["b.frag", "b.vert"]
    assert "gl_Position" in run("emit-glsl", "s.sdf", "--target", "raster", "--stage", "vertex").stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--target", "raster"), "'raster' is several files: give --stage (fragment, vertex), or -o NAME"),
        (("--target", "webgl"), "there is no target 'webgl'"),
        (("--target", "glsl330", "--stage", "compute"), "target 'glsl330' has no compute stage (it has: fragment)"),
        (("--target", "raster", "--part", "tracer"), "target 'raster' has no part 'tracer': it is a pair of stages"),
        (("--prefix", "2d"), "'2d' cannot begin names in GLSL"),
        (("--set", "radius=0.2"), "--set needs --bake"),
        (("--part", "field", "--tracer", "sphere"), "a field is not traced"),
        (("--bake", "--set", "radius=7"), "param 'radius' = 7 is outside its range"),
    ],
)
def test_refusals_are_one_line_and_exit_2(run: Run, arguments: tuple[str, ...], words: str) -> None:
    result = run("emit-glsl", "s.sdf", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert result.stdout == ""


@pytest.mark.parametrize("source", ["t.sdf", "rows.csv", "./part.sdf"])
def test_what_the_scene_is_read_from_is_not_overwritten(run: Run, tmp_path: Path, source: str) -> None:
    (tmp_path / "rows.csv").write_text("x\n1\n2\n")
    (tmp_path / "part.sdf").write_text("def ball() = sphere(radius: 0.4)\n")
    text = 'import "part.sdf"\nscene { instances("rows.csv", ball().translate([row.x, 0, 0])) }\n'
    (tmp_path / "t.sdf").write_text(text)
    before = (tmp_path / source).read_bytes()
    result = run("emit-glsl", "t.sdf", "--part", "field", "-o", source)
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "the scene was read from it" in result.stderr
    assert (tmp_path / source).read_bytes() == before
    assert run("emit-glsl", "t.sdf", "--part", "field", "-o", "other.glsl").exit_code == 0
