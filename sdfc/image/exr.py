"""OpenEXR scan-line files of 32-bit floats, ZIP compressed (Technical Introduction to OpenEXR, Kainz 2013)."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_MAGIC = struct.pack("<II", 20000630, 2)  # version 2, scan lines, short names
_FLOAT = 2
_ZIP = 3
_ROWS_IN_BLOCK = 16  # what ZIP compression means


def encode(channels: Mapping[str, NDArray[np.float32]]) -> bytes:
    """An EXR file of named float32 channels (height, width), rows from the top. R, G, B and Y are what viewers know."""
    import numpy as np

    names = sorted(channels)  # the format wants them in this order, in the header and in every row
    planes = np.stack([np.asarray(channels[name], "<f4") for name in names], axis=1)  # (height, channel, width)
    height, _, width = planes.shape
    header = _header(names, width, height)
    blocks = [_block(first, planes[first : first + _ROWS_IN_BLOCK]) for first in range(0, height, _ROWS_IN_BLOCK)]
    return b"".join([header, *_offsets(len(header), blocks), *blocks])


def _header(names: list[str], width: int, height: int) -> bytes:
    described = b"".join(name.encode() + b"\0" + struct.pack("<IB3xII", _FLOAT, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = (
        ("channels", "chlist", described + b"\0"),
        ("compression", "compression", bytes([_ZIP])),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),  # from the top
        ("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1.0)),
    )
    written = (
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value
        for name, kind, value in attributes
    )
    return _MAGIC + b"".join(written) + b"\0"


def _block(first_row: int, rows: NDArray[np.float32]) -> bytes:
    """Up to sixteen rows: even bytes, then odd ones, as differences, through zlib; as they are where that is less."""
    import numpy as np

    raw = rows.tobytes()
    data = np.frombuffer(raw, np.uint8)
    split = np.concatenate([data[0::2], data[1::2]])
    differences = split.copy()
    differences[1:] = split[1:] - split[:-1] + np.uint8(128)
    packed = zlib.compress(differences.tobytes(), 4)
    stored = packed if len(packed) < len(raw) else raw
    return struct.pack("<iI", first_row, len(stored)) + stored


def _offsets(header_size: int, blocks: list[bytes]) -> Iterator[bytes]:
    offset = header_size + 8 * len(blocks)
    for block in blocks:
        yield struct.pack("<Q", offset)
        offset += len(block)
