"""The parser's tables between runs: kept, used, made again when damaged, done without when nothing can be written."""

from pathlib import Path

import pytest

from sdfc.syntax import tables

GRAMMAR = 'start: "a" word*\nword: "b"\n%ignore " "'


class Callbacks:
    def start(self, parts: list[object]) -> object:
        return ("start", len(parts))

    def word(self, parts: list[object]) -> object:
        return "word"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "sdfc" / tables.KIND


def parsed() -> object:
    return tables.load(GRAMMAR, Callbacks()).parse("a b b")


def test_tables_are_kept_and_read_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert parsed() == ("start", 2)
    (kept,) = folder.iterdir()
    before = kept.read_bytes()

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("the grammar was compiled again")

    monkeypatch.setattr(tables, "_keep", refuse)
    assert parsed() == ("start", 2)
    assert kept.read_bytes() == before


def test_another_grammar_has_other_tables(folder: Path) -> None:
    parsed()
    tables.load(GRAMMAR + ' "\\t"', Callbacks())
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("damage", [b"", b"nonsense", b"\x80\x04N."])
def test_damaged_tables_are_made_again(folder: Path, damage: bytes) -> None:
    parsed()
    (kept,) = folder.iterdir()
    kept.write_bytes(damage)
    assert parsed() == ("start", 2)
    assert len(kept.read_bytes()) > 100


@pytest.mark.parametrize("place", [0, 40, 300, -1])
def test_tables_with_one_other_bit_are_made_again(folder: Path, place: int) -> None:
    parsed()
    (kept,) = folder.iterdir()
    damaged = bytearray(kept.read_bytes())
    damaged[place] ^= 1
    kept.write_bytes(damaged)
    assert parsed() == ("start", 2)
    assert kept.read_bytes() != bytes(damaged)


def test_no_tables_are_kept_where_nothing_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(file))
    assert parsed() == ("start", 2)


def test_a_scene_needs_no_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: (_ for _ in ()).throw(RuntimeError("no home")))
    assert parsed() == ("start", 2)
