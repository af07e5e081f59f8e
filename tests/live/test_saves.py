"""Saves are noticed, whatever becomes of the folders."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import pytest

from sdfc.live.saves import Bell, Saves

PATIENCE = 30.0  # seconds, for a machine with much else to do


def notices(saves: Saves, file: Path) -> None:
    """Some save of the file: the first ones may come before the system's watch begins."""
    until = time.monotonic() + PATIENCE
    while not saves.wait(0.1):
        assert time.monotonic() < until
        file.write_text(str(time.monotonic()))


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_folder_that_took_anothers_place_is_watched(tmp_path: Path, is_kept: bool) -> None:
    folder, file = tmp_path / "work", tmp_path / "work" / "s.sdf"
    folder.mkdir()
    with Saves(Bell()) as saves:
        saves.look_at([folder])
        notices(saves, file)
        if is_kept:
            folder.rename(tmp_path / "old")
        else:
            shutil.rmtree(folder)
        folder.mkdir()
        while saves.wait(0.5):
            pass
        saves.look_at([folder])
        notices(saves, file)
