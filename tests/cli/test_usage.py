"""What is asked for wrongly: exit code 2, one clear line, nothing written."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest
from click.testing import Result

Run = Callable[..., Result]

VERBS = ("render", "watch", "check", "explain", "emit-glsl", "list", "bench", "doctor", "completion")


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help(run: Run, verb: str) -> None:
    result = run(verb, "--help")
    assert result.exit_code == 0
    assert result.stdout.startswith(f"Usage: sdfc {verb} ")
    assert verb in run("--help").stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("rendr",), "there is no verb 'rendr' (did you mean 'render'?)"),
        (("check", "absent.sdf"), "error: cannot read 'absent.sdf': No such file or directory"),
        (("check", "."), "error: cannot read '.': Is a directory"),
        (("render", "s.sdf"), "Missing option '-o' / '--output'"),
        (
            ("render", "s.sdf", "-o", "a.jpg"),
            "cannot tell the format of 'a.jpg' by its ending (known: .png, .exr, .npy)",
        ),
        (("render", "s.sdf", "-o", "no/a.png"), "error: cannot write 'no/a.png': there is no folder 'no'"),
        (("render", "s.sdf", "-o", "a.png", "--size", "big"), "'big' is not a size like 1280x720"),
        (("render", "s.sdf", "-o", "a.png", "--size", "0x5"), "a picture of 0x5 pixels has nothing in it"),
        (("render", "s.sdf", "-o", "a.png", "--size", "99999x5"), "a picture of 99999x5 pixels is too large"),
        (("render", "s.sdf", "-o", "a.png", "--samples", "0"), "0 is not in the range x>=1"),
        (("render", "s.sdf", "-o", "a.png", "--aov", "dept"), "there is no image 'dept' (did you mean 'depth'?)"),
        (("render", "s.sdf", "-o", "-", "--aov", "depth"), "images beside the picture need its file's name"),
        (("render", "s.sdf", "-o", "a.png", "--set", "radius"), "'radius' is not of the form name=value"),
        (
            ("render", "s.sdf", "-o", "a.png", "--set", "radius=x"),
            "'x' is not a value like 0.5, 30deg, 1,2,3 or #ff8800",
        ),
        (("render", "s.sdf", "-o", "a.png", "--set", "radius=1", "--set", "radius=1"), "'radius' is set twice"),
        (("render", "s.sdf", "-o", "a.png", "--set", "radus=1"), "has no param 'radus' (did you mean 'radius'?)"),
        (("render", "s.sdf", "-o", "a.png", "--set", "radius=7"), "param 'radius' = 7 is outside its range, 0.1..1"),
        (("render", "s.sdf", "-o", "a.png", "--set", "turn=91deg"), "'turn' = 91deg is outside its range, 0deg..90deg"),
        (("render", "s.sdf", "-o", "a.png", "--set", "turn=9"), "'turn' is an angle: write 9deg or 9rad"),
        (("render", "s.sdf", "-o", "a.png", "--set", "radius=1,2"), "param 'radius' takes a number, not 2"),
        (("render", "s.sdf", "-o", "a.png", "--camera", "eye=1,2"), "the camera's eye takes three numbers"),
        (("render", "s.sdf", "-o", "a.png", "--camera", "tarjet=1,2,3"), "no 'tarjet' (did you mean 'target'?)"),
        (("render", "s.sdf", "-o", "a.png", "--camera", "fov=200deg"), "fov must be between 0deg and 180deg"),
        (("render", "s.sdf", "-o", "a.png", "--camera", "fov=35"), "'fov' is an angle: write 35deg or 35rad"),
        (("render", "s.sdf", "-o", "a.png", "--camera", "up=0,0,0"), "the camera's up direction is zero"),
        (
            ("render", "s.sdf", "-o", "a.png", "--tracer", "prven"),
            "there is no tracer 'prven' (did you mean 'proven'?)",
        ),
        (("check", "s.sdf", "--after", "fold"), "--after goes with --show shape"),
        (("check", "s.sdf", "--show", "shape", "--after", "plase"), "there is no pass 'plase' (did you mean 'place'?)"),
        (("emit-glsl", "s.sdf", "-o", "no/a.frag"), "cannot write 'no/a.frag': there is no folder 'no'"),
        (("list", "primitive"), "'primitive' is not one of"),
    ],
)
def test_wrong_usage_is_exit_2_and_says_what_is_wrong(run: Run, arguments: tuple[str, ...], message: str) -> None:
    result = run(*arguments)
    assert message in " ".join(result.stderr.split()), result.stderr
    assert result.exit_code == 2
    assert result.stdout == ""
    assert os.listdir() == ["s.sdf"]


def test_usage_errors_of_a_json_call_are_json(run: Run) -> None:
    import json

    result = run("check", "absent.sdf", "--json")
    assert result.exit_code == 2
    assert json.loads(result.stdout) == {
        "ok": False,
        "exit": 2,
        "message": "cannot read 'absent.sdf': No such file or directory",
    }


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_scripts_call_sdfc(run: Run, shell: str) -> None:
    result = run("completion", shell)
    assert result.exit_code == 0
    assert f"_SDFC_COMPLETE={shell}_complete" in result.stdout
