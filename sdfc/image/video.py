"""MP4 with H.264, by ffmpeg: imageio-ffmpeg's (the extra `video`), or the system's."""

from __future__ import annotations

import contextlib
import importlib
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from sdfc.image.write import OutputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MISSING = "an .mp4 is made by ffmpeg, which is not here: pip install 'sdfc[video]' (or write a .gif, or out_%04d.png)"
_QUALITY = "16"  # constant rate factor: nothing to be seen of the compression
_COLOURS = "setparams=range=tv:colorspace=bt709:color_primaries=bt709:color_trc=bt709"  # said in the file
_ENCODING = (
    *("-vf", f"scale=out_color_matrix=bt709:out_range=tv,{_COLOURS}", "-pix_fmt", "yuv420p"),  # for every player
    *("-c:v", "libx264", "-preset", "medium", "-crf", _QUALITY, "-movflags", "+faststart", "-f", "mp4"),
)


class Mp4:
    """An MP4 in the making; see Film. ffmpeg works beside us, into a temporary folder."""

    def __init__(self, size: tuple[int, int], fps: float) -> None:
        if any(side % 2 for side in size):
            raise OutputError(f"an .mp4 has an even width and height, not {size[0]}x{size[1]}")
        self._command = [ffmpeg(), *_input(size, fps), *_ENCODING]
        self._folder: Path | None = None
        self._process: subprocess.Popen[bytes] | None = None

    def add(self, pixels: NDArray[np.uint8]) -> None:
        """See Film."""
        import numpy as np

        stream = self._started().stdin
        assert stream is not None
        try:
            stream.write(np.ascontiguousarray(pixels).tobytes())
        except OSError:
            self._fail()

    def finish(self) -> bytes:
        """See Film."""
        process = self._started()
        assert process.stdin is not None
        with contextlib.suppress(OSError):  # what it did not take, its exit code tells
            process.stdin.close()
        if process.wait() != 0:
            self._fail()
        return self._path("film.mp4").read_bytes()

    def close(self) -> None:
        """See Film."""
        if self._process is not None:
            self._process.kill()
            if self._process.stdin is not None:
                with contextlib.suppress(OSError):
                    self._process.stdin.close()
            self._process.wait()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
        self._process = self._folder = None

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            self._folder = Path(tempfile.mkdtemp(prefix="sdfc-"))
            with open(self._path("words"), "wb") as words:  # a pipe could fill while we write to the other one
                self._process = subprocess.Popen(
                    [*self._command, str(self._path("film.mp4"))],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.DEVNULL,
                    stderr=words,
                    start_new_session=True,  # Ctrl-C is for us
                )
        return self._process

    def _path(self, name: str) -> Path:
        assert self._folder is not None
        return self._folder / name

    def _fail(self) -> NoReturn:
        words = self._path("words").read_text(errors="replace").strip().splitlines()
        raise OutputError(f"ffmpeg could not make the .mp4: {words[-1] if words else 'it said nothing'}") from None


def ffmpeg() -> str:
    """Where ffmpeg is. Raises OutputError with what to install where it is not."""
    try:
        return str(importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):  # not installed, or without a binary for this machine
        found = shutil.which("ffmpeg")
    if found is None:
        raise OutputError(MISSING)
    return found


def _input(size: tuple[int, int], fps: float) -> list[str]:
    """What is written to ffmpeg: bare pixels."""
    shape = ["-s", f"{size[0]}x{size[1]}", "-pix_fmt", "rgb24", "-framerate", repr(float(fps))]
    return ["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", *shape, "-i", "-"]
