"""What each verb says of a right scene."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result

Run = Callable[..., Result]

CSG = "group() { sphere($fn = 0, $fa = 12, $fs = 2, r = 1); }\n"


def test_check_counts_what_there_is(run: Run) -> None:
    assert run("check", "s.sdf").stdout == "s.sdf: nothing wrong (3 shapes, 2 params, 0 lights, 0 warnings)\n"
    told = json.loads(run("check", "s.sdf", "--json").stdout)
    assert (told["ok"], told["shapes"], told["params"], told["diagnostics"]) == (True, 3, 2, [])


def test_show_prints_each_form(run: Run) -> None:
    assert "SceneDeclaration" in run("check", "s.sdf", "--show", "syntax").stdout
    shape = run("check", "s.sdf", "--show", "shape").stdout
    assert "sphere(radius: radius)" in shape
    assert "paint(" in shape
    assert "length(" in run("check", "s.sdf", "--show", "field").stdout
    assert "closed form" in run("check", "s.sdf", "--show", "plan").stdout
    assert run("check", "s.sdf", "--show", "glsl").stdout == run("emit-glsl", "s.sdf").stdout
    told = json.loads(run("check", "s.sdf", "--show", "shape", "--json").stdout)
    assert (told["form"], told["text"] + "\n") == ("shape", shape)


def test_show_after_each_pass(run: Run) -> None:
    from sdfc.pipeline import PASSES

    before = run("check", "s.sdf", "--show", "shape").stdout
    shapes = [run("check", "s.sdf", "--show", "shape", "--after", step.name).stdout for step in PASSES]
    assert all(shape.strip() for shape in shapes)
    assert shapes[-1] != before


def test_explain_gives_reasons(run: Run) -> None:
    result = run("explain", "s.sdf")
    assert result.exit_code == 0
    assert "tracer: proven" in result.stdout
    assert "closed form" in result.stdout
    assert json.loads(run("explain", "s.sdf", "--json").stdout)["explanation"] == result.stdout.splitlines()
    assert "tracer: sphere" in run("explain", "s.sdf", "--tracer", "sphere").stdout


def test_emit_glsl_goes_to_stdout_or_a_file_in_both_stages(run: Run, tmp_path: Path) -> None:
    fragment = run("emit-glsl", "s.sdf")
    assert fragment.stdout.startswith("#version 450")
    assert run("emit-glsl", "s.sdf", "-o", "s.frag").stdout == ""
    assert (tmp_path / "s.frag").read_text().strip() == fragment.stdout.strip()
    assert "local_size_x" in run("emit-glsl", "s.sdf", "--stage", "compute").stdout
    assert run("emit-glsl", "-", stdin=(tmp_path / "s.sdf").read_text()).stdout.count("\n") == fragment.stdout.count(
        "\n"
    )


def test_csg_by_ending_by_option_and_not_by_chance(run: Run, tmp_path: Path) -> None:
    (tmp_path / "m.csg").write_text(CSG)
    assert run("check", "m.csg").exit_code == 0
    assert run("check", "-", "--format", "csg", stdin=CSG).exit_code == 0
    assert run("check", "-", stdin=CSG).exit_code == 1


@pytest.mark.parametrize("kind", ["primitives", "operations", "tracers", "targets"])
def test_list_describes_every_row(run: Run, kind: str) -> None:
    told = json.loads(run("list", kind, "--json").stdout)
    assert list(told) == ["ok", kind]
    assert all(row["use"] and row["description"] for row in told[kind])
    words = run("list", kind).stdout
    assert words.startswith(f"{kind} ({len(told[kind])})\n")
    assert all(row["use"] in words for row in told[kind])


def test_list_has_what_a_scene_is_made_of(run: Run) -> None:
    words = run("list").stdout
    for text in (
        "  sphere(radius: length > 0 = 0.5)\n",
        "  solid.round(",
        "  solid.translate(",
        "  union {",
        "  proven\n",
    ):
        assert text in words


def test_doctor_tells_what_there_is(run: Run) -> None:
    result = run("doctor")
    told = json.loads(run("doctor", "--json").stdout)
    assert set(told) == {"ok", "healthy", "versions", "device", "folders", "trials", "verdict", "install"}
    assert told["verdict"] in result.stdout
    assert result.exit_code == (0 if told["healthy"] else 3)


def test_doctor_without_opengl_says_what_to_install_and_exits_3(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sdfc.gpu.device._EGL_LIBRARIES", ({"libgl": "libNone.so", "libegl": "libNone.so"},))
    result = run("doctor")
    assert result.exit_code == 3
    assert "  apt-get install --no-install-recommends libegl1 libgl1 libgl1-mesa-dri\n" in result.stdout
    assert "until then scenes render with NumPy" in result.stdout
