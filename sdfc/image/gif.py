"""Animated GIF (GIF89a specification, CompuServe 1990), repeated for ever.

Every frame has colours of its own, and holds only what changed since the last: still pixels keep what they show.
"""

from __future__ import annotations

import heapq
import itertools
import struct
from typing import TYPE_CHECKING, Any

from sdfc.image.write import OutputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Pixels = NDArray[np.uint8]

FASTEST = 50.0  # frames a second: viewers show what asks for less than 2/100 s slowly
_TRANSPARENT = 0  # the index of what stays as it was
_MOST_COLOURS = 255  # and transparent
_REPEAT = b"\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"  # for ever
_MOST_CODES = 4096
_LONGEST_CODE = 12  # bits


class Gif:
    """A GIF in the making; see Film. Delays are whole hundredths of a second, and right in the sum."""

    def __init__(self, size: tuple[int, int], fps: float) -> None:
        if fps > FASTEST:
            raise OutputError(f"a .gif shows at most {FASTEST:g} frames a second, not {fps:g}")
        self._fps = fps
        self._count = 0
        self._shown: Pixels | None = None
        self._parts = [b"GIF89a", struct.pack("<HHBBB", *size, 0, 0, 0), _REPEAT]

    def add(self, pixels: Pixels) -> None:
        """See Film."""
        import numpy as np

        changed = np.ones(pixels.shape[:2], bool) if self._shown is None else (pixels != self._shown).any(axis=2)
        changed[0, 0] |= not changed.any()  # a frame has at least a pixel
        rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        palette, indices = quantised(pixels[changed])
        image = np.full(changed.shape, _TRANSPARENT, np.uint8)
        image[changed] = indices + 1
        begun, self._count = self._count, self._count + 1
        delay = round(100.0 * self._count / self._fps) - round(100.0 * begun / self._fps)
        self._parts += _frame(image[box], (int(columns[0]), int(rows[0])), palette, delay)
        self._shown = pixels.copy()

    def finish(self) -> bytes:
        """See Film."""
        return b"".join([*self._parts, b";"])

    def close(self) -> None:
        """Holds nothing outside itself."""


def quantised(colours: Pixels) -> tuple[Pixels, Pixels]:
    """At most 255 colours (k, 3) for colours (n, 3), and which of them each is; exact where there are no more.

    The set that differs most along an axis is cut at its mean there, again and again (after Heckbert's median cut,
    1982, with variances as in Wu 1991).
    """
    import numpy as np

    packed = colours.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    unique, inverse, counts = np.unique(packed, return_inverse=True, return_counts=True)
    points = (unique[:, None] >> np.array([16, 8, 0], np.uint32) & 255).astype(np.float64)
    sets = _cut(points, counts.astype(np.float64))
    palette, of_unique = np.empty((len(sets), 3), np.uint8), np.empty(len(unique), np.uint8)
    for index, members in enumerate(sets):
        palette[index] = np.round(np.average(points[members], axis=0, weights=counts[members]))
        of_unique[members] = index
    return palette, of_unique[inverse]


def _cut(points: NDArray[np.float64], weights: NDArray[np.float64]) -> list[NDArray[np.intp]]:
    """The points' indices in at most _MOST_COLOURS sets."""
    import numpy as np

    if len(points) <= _MOST_COLOURS:
        return [np.array([index]) for index in range(len(points))]
    ties = itertools.count()  # arrays cannot be compared

    def entry(members: NDArray[np.intp]) -> tuple[float, int, int, float, NDArray[np.intp]]:
        own, share = points[members], weights[members]
        mean = np.average(own, axis=0, weights=share)
        spread = share @ (own - mean) ** 2
        axis = int(spread.argmax())
        return -float(spread[axis]), next(ties), axis, float(mean[axis]), members

    heap = [entry(np.arange(len(points)))]
    while len(heap) < _MOST_COLOURS:
        _, _, axis, mean, members = heapq.heappop(heap)
        is_below = points[members, axis] <= mean
        heapq.heappush(heap, entry(members[is_below]))
        heapq.heappush(heap, entry(members[~is_below]))
    return [members for *_, members in heap]


def _frame(image: Pixels, corner: tuple[int, int], palette: Pixels, delay: int) -> list[bytes]:
    """One frame's blocks: it is laid over what is there, and stays. Palette index k is image index k + 1."""
    height, width = image.shape
    bits = max(2, len(palette).bit_length())  # of an index, transparent included
    table = (b"\0\0\0" + palette.tobytes()).ljust(3 << bits, b"\0")
    data = lzw(image.tobytes(), bits)
    blocks = (data[start : start + 255] for start in range(0, len(data), 255))
    return [
        b"\x21\xf9\x04" + struct.pack("<BHB", 0b00000101, min(delay, 65535), _TRANSPARENT) + b"\0",
        b"\x2c" + struct.pack("<HHHHB", *corner, width, height, 0x80 | bits - 1),
        table,
        bytes([bits]),
        *(bytes([len(block)]) + block for block in blocks),
        b"\0",
    ]


def lzw(indices: bytes, bits: int) -> bytes:
    """GIF's variable-length codes (Welch 1984) for indices of `bits` bits each, at least one of them."""
    import numpy as np

    clear = 1 << bits
    blocks = _codes(indices, clear)
    blocks[-1][-1] = clear + 1  # the end, in place of another beginning
    values = np.concatenate([np.array([clear]), *(np.array(block) for block in blocks)])
    # The n-th code of a block is as long as the table's next entry needs, which is `clear` + n.
    places = np.concatenate([np.arange(1, len(block) + 1) for block in blocks])
    lengths = np.concatenate([[bits + 1], np.clip(np.frexp(clear + places)[1], bits + 1, _LONGEST_CODE)])
    columns = np.arange(_LONGEST_CODE)
    is_used: NDArray[Any] = columns < lengths[:, None]
    return np.packbits((values[:, None] >> columns & 1)[is_used].astype(np.uint8), bitorder="little").tobytes()


def _codes(indices: bytes, clear: int) -> list[list[int]]:
    """The codes in blocks, each of which fills one table, or is the last, and ends with `clear`."""
    table: dict[int, int] = {}
    following = clear + 2
    blocks: list[list[int]] = [[]]
    put = blocks[-1].append
    prefix = indices[0]
    for index in indices[1:]:
        key = prefix << 8 | index
        code = table.get(key)
        if code is not None:
            prefix = code
            continue
        put(prefix)
        prefix = index
        table[key] = following
        following += 1
        if following == _MOST_CODES:
            put(clear)
            table.clear()
            following = clear + 2
            blocks.append([])
            put = blocks[-1].append
    put(prefix)
    put(clear)
    return blocks
