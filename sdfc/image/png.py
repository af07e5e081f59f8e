"""PNG, from arrays."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOUR_TYPES = {1: 0, 3: 2, 4: 6}  # samples a pixel -> gray, RGB, RGB with alpha
SMALL, QUICK = 4, 1  # levels of zlib
_UP = 2  # the filter that stores each row less the one above it


def encode(pixels: NDArray[np.uint8] | NDArray[np.uint16], level: int = SMALL) -> bytes:
    """A PNG file of (height, width), (height, width, 3) or (height, width, 4) samples, 8 or 16 bits, rows from the top.

    The Up filter is as small as a search over filters for rendered pictures, and several times faster (GL.md 8).
    SMALL takes 0.35 to 0.45 of the time of zlib's own 6, for files that are 7 to 15 % larger (four scenes, 640x360);
    QUICK 0.6 of that, for 17 to 24 % more.
    """
    height, width = pixels.shape[:2]
    samples = pixels.shape[2] if pixels.ndim == 3 else 1
    bits = pixels.dtype.itemsize * 8
    if samples not in _COLOUR_TYPES or pixels.dtype.kind != "u" or bits not in (8, 16):
        raise ValueError(f"a PNG cannot hold {pixels.dtype} samples of shape {pixels.shape}")
    header = struct.pack(">IIBBBBB", width, height, bits, _COLOUR_TYPES[samples], 0, 0, 0)
    data = zlib.compress(_filtered(pixels), level)
    return _SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"sRGB", b"\0") + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


def _filtered(pixels: NDArray[Any]) -> bytes:
    import numpy as np

    height = pixels.shape[0]
    big_endian = np.ascontiguousarray(pixels.astype(pixels.dtype.newbyteorder(">")))
    rows = big_endian.view(np.uint8).reshape(height, -1)
    filtered = np.empty((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 0] = _UP
    filtered[:1, 1:] = rows[:1]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    return filtered.tobytes()


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
