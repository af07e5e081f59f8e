"""What is kept between runs comes back as it was, or not at all; nothing that goes wrong there is an error."""

import os
from pathlib import Path

import numpy as np
import pytest

from sdfc.measure import store

ARRAYS = {"t": np.array([1.0, np.inf, np.nan, -0.0]), "hit": np.array([True, False, True, False])}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SDFC_CACHE_DIR", str(tmp_path))
    return tmp_path


def same(found: dict[str, np.ndarray] | None) -> bool:
    return found is not None and all(found[name].tobytes() == ARRAYS[name].tobytes() for name in ARRAYS)


def test_what_was_kept_comes_back_bit_by_bit() -> None:
    assert store.load("truth", "a") is None
    assert store.save("truth", "a", ARRAYS)
    assert same(store.load("truth", "a"))
    assert store.load("truth", "b") is None and store.load("other", "a") is None


def test_a_later_answer_replaces_an_earlier_one() -> None:
    store.save("truth", "a", {"t": np.zeros(3)})
    store.save("truth", "a", ARRAYS)
    assert same(store.load("truth", "a"))


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04", b"no archive at all"])
def test_a_broken_file_is_no_file(folder: Path, damage: bytes) -> None:
    store.save("truth", "a", ARRAYS)
    (file,) = (folder / "truth").iterdir()
    file.write_bytes(damage)
    assert store.load("truth", "a") is None
    assert store.save("truth", "a", ARRAYS) and same(store.load("truth", "a"))


@pytest.mark.parametrize("kept", [0.3, 0.6, 0.95])
def test_half_a_file_is_no_file(folder: Path, kept: float) -> None:
    store.save("truth", "a", ARRAYS)
    (file,) = (folder / "truth").iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[: int(kept * len(whole))])
    assert store.load("truth", "a") is None


def test_a_flipped_bit_is_noticed(folder: Path) -> None:
    noise = {"t": np.random.default_rng(1).random(1000)}
    store.save("truth", "a", noise)
    (file,) = (folder / "truth").iterdir()
    whole = bytearray(file.read_bytes())
    whole[len(whole) // 2] ^= 1
    file.write_bytes(whole)
    assert store.load("truth", "a") is None


def test_a_folder_that_cannot_be_made_keeps_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "file").write_text("in the way")
    monkeypatch.setenv("SDFC_CACHE_DIR", str(folder / "file"))
    assert not store.save("truth", "a", ARRAYS)
    assert store.load("truth", "a") is None


def test_nothing_is_left_of_a_write_that_failed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*args: object, **arrays: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    assert not store.save("truth", "a", ARRAYS)
    assert list((folder / "truth").iterdir()) == []


def test_what_was_not_used_for_longest_goes_first(folder: Path) -> None:
    block = {"t": np.random.default_rng(1).random(1000)}  # about 8000 bytes that do not compress
    for age, key in enumerate("abcd"):
        store.save("truth", key, block)
        os.utime(folder / "truth" / f"{key}.npz", (1000.0 + age, 1000.0 + age))
    store.load("truth", "a")  # used now
    store.save("truth", "e", block, most_bytes=25_000)
    assert sorted(path.stem for path in (folder / "truth").iterdir()) == ["a", "d", "e"]
