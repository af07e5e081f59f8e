"""A scene that is wrong: exit code 1, the place with a caret, in words or as JSON; and bugs: exit code 70."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result

Run = Callable[..., Result]

MISSPELT = "scene { sphere(radus: 0.1) }\n"
SHOWN = """\
bad.sdf:1:16: error: sphere has no parameter 'radus'
    1 | scene { sphere(radus: 0.1) }
      |                ^^^^^ did you mean 'radius'?
"""


@pytest.mark.parametrize(
    "verb",
    [("check",), ("explain",), ("emit-glsl",), ("render", "-o", "a.png"), ("check", "--show", "shape")],
    ids=" ".join,
)
def test_every_verb_shows_the_place_with_a_caret_and_exits_1(run: Run, tmp_path: Path, verb: tuple[str, ...]) -> None:
    (tmp_path / "bad.sdf").write_text(MISSPELT)
    result = run(*verb, "bad.sdf")
    assert result.stderr == SHOWN
    assert result.stdout == ""
    assert result.exit_code == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.sdf", "s.sdf"]


def test_json_says_the_same(run: Run) -> None:
    result = run("check", "-", "--json", stdin=MISSPELT)
    assert result.exit_code == 1
    assert result.stderr == ""
    assert json.loads(result.stdout) == {
        "ok": False,
        "exit": 1,
        "diagnostics": [
            {
                "severity": "error",
                "message": "sphere has no parameter 'radus'",
                "hint": "did you mean 'radius'?",
                "file": "<stdin>",
                "line": 1,
                "column": 16,
                "end_line": 1,
                "end_column": 21,
            }
        ],
    }


def test_several_errors_are_told_at_once(run: Run) -> None:
    result = run("check", "-", stdin="scene {\n  sphere(radus: 1)\n  bx(1)\n}\n")
    assert result.stderr.count("error: ") == 2
    assert result.exit_code == 1


def test_a_warning_is_told_and_is_no_failure(run: Run) -> None:
    result = run("check", "-", stdin="def unused() = sphere(1)\nscene { sphere(1) }\n")
    assert "<stdin>:1:5: warning: the def 'unused' is never used" in result.stderr
    assert result.stdout == "-: nothing wrong (1 shapes, 0 params, 0 lights, 1 warnings)\n"
    assert result.exit_code == 0


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"scene { \xff }", "error: <stdin> is not UTF-8 text (byte 0xff in line 1)"),
        (b"\n\n\x80", "error: <stdin> is not UTF-8 text (byte 0x80 in line 3)"),
    ],
)
def test_what_is_no_text_is_a_wrong_scene(run: Run, data: bytes, message: str) -> None:
    result = run("check", "-", stdin=data)
    assert result.stderr.splitlines()[0] == message
    assert result.exit_code == 1


def test_an_endless_file_ends_soon(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sdfc.api.source.LARGEST_FILE", 1 << 20)
    result = run("check", "/dev/zero")
    assert result.stderr == "error: /dev/zero is larger than 1 MiB\n"
    assert result.exit_code == 1


def test_byte_order_marks_and_other_line_ends_are_understood(run: Run) -> None:
    result = run("check", "-", stdin=b"\xef\xbb\xbfscene {\r\n  sphere(radus: 1)\r\n}\r\n")
    assert result.stderr.startswith("<stdin>:2:10: error: ")


@pytest.fixture
def broken_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """A compiler with a bug in it."""
    import sdfc.pipeline

    def fail(*_: object, **__: object) -> None:
        raise KeyError("lost")

    monkeypatch.setattr(sdfc.pipeline, "normalise", fail)
    monkeypatch.delenv("SDFC_DEBUG", raising=False)


@pytest.mark.usefixtures("broken_compiler")
def test_a_bug_is_told_as_one_without_a_traceback(run: Run) -> None:
    result = run("emit-glsl", "s.sdf")
    assert result.exit_code == 70
    assert result.stderr == (
        "error: this is a bug in sdfc, in its pipeline stage: KeyError: 'lost'\n"
        "  please report it with the scene; SDFC_DEBUG=1 shows the traceback\n"
    )
    told = json.loads(run("emit-glsl", "s.sdf", "--json").stdout)
    assert told == {"ok": False, "exit": 70, "message": "KeyError: 'lost'", "stage": "pipeline"}


@pytest.mark.usefixtures("broken_compiler")
def test_a_bug_shows_its_traceback_when_asked(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDFC_DEBUG", "1")
    result = run("emit-glsl", "s.sdf")
    assert result.exit_code == 70
    assert "Traceback (most recent call last):" in result.stderr
    assert "KeyError: 'lost'" in result.stderr
