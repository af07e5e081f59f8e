"""Compiled templates between runs: kept, used, made again when damaged, done without when nothing can be written."""

import hashlib
from pathlib import Path

import pytest
from jinja2 import DictLoader, Environment

from sdfc.glsl import templates
from sdfc.glsl.templates import KeptTemplates


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SDFC_CACHE_DIR", str(tmp_path))
    return tmp_path / templates.KIND


def rendered(text: str = "{{ a }} + 1") -> str:
    environment = Environment(loader=DictLoader({"sum": text}), bytecode_cache=KeptTemplates())
    return environment.get_template("sum").render(a=2)


def test_a_template_is_compiled_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert rendered() == "2 + 1"
    (kept,) = folder.iterdir()
    before = kept.read_bytes()

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("the template was compiled again")

    monkeypatch.setattr(Environment, "_generate", refuse)
    assert rendered() == "2 + 1"
    assert kept.read_bytes() == before


def test_a_template_that_was_edited_is_compiled_again(folder: Path) -> None:
    rendered()
    assert rendered("{{ a }} + 3") == "2 + 3"
    assert len(list(folder.iterdir())) == 1


@pytest.mark.parametrize("kept_of_it", [0, 10, 40, 120])
def test_a_damaged_one_is_made_again(folder: Path, kept_of_it: int) -> None:
    rendered()
    (kept,) = folder.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[:kept_of_it])
    assert rendered() == "2 + 1"
    assert kept.read_bytes() == whole


@pytest.mark.parametrize("place", [0, 40, 120, -1])
def test_one_with_another_bit_is_made_again(folder: Path, place: int) -> None:
    """Damaged bytecode would end the process, or print another text."""
    rendered()
    (kept,) = folder.iterdir()
    whole = kept.read_bytes()
    damaged = bytearray(whole)
    damaged[place] ^= 1
    kept.write_bytes(damaged)
    assert rendered() == "2 + 1"
    assert kept.read_bytes() == whole


def test_code_that_another_user_left_is_not_run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rendered()
    (kept,) = folder.iterdir()
    code = kept.read_bytes()[32:].replace(b" + 1", b" - 1")
    kept.write_bytes(hashlib.sha256(code).digest() + code)
    assert rendered() == "2 - 1"
    monkeypatch.setattr("os.getuid", lambda: -1)
    assert rendered() == "2 + 1"


def test_nothing_is_kept_where_nothing_can_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDFC_CACHE_DIR", "/dev/null/nowhere")
    assert rendered() == "2 + 1"
