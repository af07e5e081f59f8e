"""MP4s, read back by ffmpeg."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest

from sdfc.image import video
from sdfc.image.video import Mp4, ffmpeg
from sdfc.image.write import OutputError

SIZE = (64, 48)


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where temporary files go."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    return tmp_path / "temporary"


def test_its_frames_are_what_was_put_in(tmp_path: Path, temporary: Path) -> None:
    colours = [(200, 40, 40), (40, 200, 40), (40, 40, 200), (128, 128, 128), (255, 255, 255), (0, 0, 0)]
    film = Mp4(SIZE, 12.0)
    for colour in colours:
        film.add(np.broadcast_to(np.array(colour, np.uint8), (48, 64, 3)))
    (tmp_path / "film.mp4").write_bytes(film.finish())
    film.close()
    assert os.listdir(temporary) == []
    command = [ffmpeg(), "-v", "error", "-i", str(tmp_path / "film.mp4"), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    shown = np.frombuffer(raw, np.uint8).reshape(-1, 48, 64, 3)
    assert len(shown) == len(colours)
    for picture, colour in zip(shown, colours, strict=True):
        assert np.abs(picture.astype(int) - colour).max() <= 6


def test_a_film_that_is_given_up_leaves_nothing(temporary: Path) -> None:
    film = Mp4(SIZE, 30.0)
    film.add(np.zeros((48, 64, 3), np.uint8))
    assert len(os.listdir(temporary)) == 1
    film.close()
    assert os.listdir(temporary) == []


def test_odd_sizes_are_refused_before_anything_is_drawn() -> None:
    with pytest.raises(OutputError, match="even width and height, not 63x48"):
        Mp4((63, 48), 30.0)


def test_without_ffmpeg_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(video.importlib, "import_module", missing)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(OutputError, match=r"pip install 'sdfc\[video\]'"):
        Mp4(SIZE, 30.0)


def test_what_ffmpeg_says_is_told(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(video, "_ENCODING", ("-c:v", "no_such_encoder", "-f", "mp4"))
    film = Mp4(SIZE, 30.0)
    with pytest.raises(OutputError, match=r"ffmpeg could not make the \.mp4: \S"):
        for _ in range(50):
            film.add(np.zeros((48, 64, 3), np.uint8))
        film.finish()
    film.close()
    assert os.listdir(temporary) == []
