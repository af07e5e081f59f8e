"""Frames of a device, lent; for an animation they are kept from picture to picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame


class Frames:
    """Lends frames. One that is given back is freed at once, or lent again while somebody asks that they be kept."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._free: dict[tuple[int, int, int], list[Frame]] = {}
        self._keepers = 0

    @contextmanager
    def lent(self, width: int, height: int, attachments: int = 1) -> Iterator[Frame]:
        """A frame of that size that nobody else has; what it shows is what it showed last."""
        free = self._free.setdefault((width, height, attachments), [])
        frame = free.pop() if free else Frame(self._device, width, height, attachments)
        try:
            yield frame
        finally:
            if self._keepers:
                free.append(frame)
            else:
                frame.release()

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Meanwhile, frames that are given back are kept for the next who asks for their size."""
        self._keepers += 1
        try:
            yield
        finally:
            self._keepers -= 1
            if not self._keepers:
                self.release()

    def release(self) -> None:
        """Free the frames that are kept."""
        while self._free:
            for frame in self._free.popitem()[1]:
                frame.release()
