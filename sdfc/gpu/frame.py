"""Drawing a program into float images, in bands, so that it can be watched and stopped."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self, TypeAlias

from sdfc.diagnostics import DeviceError
from sdfc.gpu.device import Device, device_errors
from sdfc.gpu.program import FragmentProgram, Value

if TYPE_CHECKING:
    import moderngl
    import numpy as np
    from numpy.typing import NDArray

Progress: TypeAlias = Callable[[float], None]  # told the share done, 0 to 1

UNDRAWN = (0.0, 0.0, 0.0, -1.0)
"""What a pixel holds that no program wrote: known by its alpha, in programs that write none below 0."""

_FIRST_BAND = 64  # rows: llvmpipe works in tiles of 64
_SMALLEST_BAND = 4
_BAND_SECONDS = 0.2  # the wait between bands costs nothing, and Ctrl-C and drivers' watchdogs are content
_MOST_GROWTH = 4.0


class Frame:
    """A framebuffer of `attachments` RGBA32F images, `width` by `height`.

    One format for everything: llvmpipe compiles a program again for each format that it draws into (GL.md 0).
    """

    def __init__(self, device: Device, width: int, height: int, attachments: int = 1) -> None:
        if max(width, height) > device.max_size:
            raise DeviceError(f"{device.renderer} draws at most {device.max_size} pixels across, not {width}x{height}")
        if attachments > device.max_attachments:
            raise DeviceError(f"{device.renderer} draws at most {device.max_attachments} images at once")
        self.device = device
        self.width = width
        self.height = height
        device.make_current()
        with device_errors(device, f"making a frame of {width}x{height}"):
            self._images: list[moderngl.Texture] = [
                device.context.texture((width, height), 4, dtype="f4") for _ in range(attachments)
            ]
            self._framebuffer = device.context.framebuffer(self._images)

    def draw(self, program: FragmentProgram, uniforms: Mapping[str, Value], progress: Progress | None = None) -> None:
        """Draw the whole frame. `progress` is called after every band and may raise to stop."""
        program.set(uniforms)
        with self._in_use(), device_errors(self.device, "drawing"):
            self._framebuffer.clear(*UNDRAWN)
            self._draw_rows(program, 0, 1)  # the driver compiles at the first draw: not to be taken for a slow band
            row, rows = 0, _FIRST_BAND
            while row < self.height:
                rows = min(rows, self.height - row)
                started = time.perf_counter()
                self._draw_rows(program, row, rows)
                row += rows
                rows = _next_band(rows, time.perf_counter() - started)
                if progress is not None:
                    progress(row / self.height)

    def draw_whole(self, program: FragmentProgram, uniforms: Mapping[str, Value]) -> None:
        """Draw the whole frame at once, and wait for it: for measuring, not for machines with a watchdog."""
        program.set(uniforms)
        with self._in_use(), device_errors(self.device, "drawing"):
            program.draw()
            self.device.context.finish()

    def _draw_rows(self, program: FragmentProgram, row: int, rows: int) -> None:
        """Draw `rows` rows, `row` rows below the top (OpenGL counts from the bottom)."""
        self._framebuffer.scissor = (0, self.height - row - rows, self.width, rows)
        program.draw()
        self.device.context.finish()

    def bind(self, unit: int = 0, attachment: int = 0) -> None:
        """Let the programs that are drawn next read an image, as texture `unit`."""
        self.device.make_current()
        self._images[attachment].use(unit)

    def read(self, attachment: int = 0) -> NDArray[np.float32]:
        """One image as float32 (height, width, 4), rows from the top."""
        import numpy as np

        self.device.make_current()
        with device_errors(self.device, "reading the frame back"):
            data = self._framebuffer.read(components=4, attachment=attachment, dtype="f4")
        return np.frombuffer(data, np.float32).reshape(self.height, self.width, 4)[::-1]

    @contextmanager
    def _in_use(self) -> Iterator[None]:
        self.device.make_current()
        self._framebuffer.use()
        try:
            yield
        finally:
            self._framebuffer.scissor = (0, 0, self.width, self.height)

    def release(self) -> None:
        """Free the images on the device."""
        self.device.make_current()
        # Never release a framebuffer in use: making the next one would bind its dead name again (moderngl 5.13).
        self.device.context.detect_framebuffer(0).use()
        self._framebuffer.release()
        for image in self._images:
            image.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.release()


def _next_band(rows: int, seconds: float) -> int:
    """How many rows to draw next, for a band to take about _BAND_SECONDS."""
    growth = min(_MOST_GROWTH, _BAND_SECONDS / max(seconds, 1e-6))
    return max(_SMALLEST_BAND, int(rows * growth))
