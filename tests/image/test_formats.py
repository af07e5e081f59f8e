"""The image writers, read back by readers that share nothing with them."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sdfc.image import exr, npy, png


def decode_png(data: bytes) -> NDArray[np.integer]:
    """A PNG with any filter of each row, by the specification's words (RFC 2083)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, body, kinds = 8, b"", []
    while place < len(data):
        (length,) = struct.unpack_from(">I", data, place)
        kind, content = data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        assert struct.unpack_from(">I", data, place + 8 + length)[0] == zlib.crc32(kind + content)
        kinds.append(kind)
        if kind == b"IHDR":
            width, height, bits, colour, *_ = struct.unpack(">IIBBBBB", content)
        body += content if kind == b"IDAT" else b""
        place += 12 + length
    assert kinds[0] == b"IHDR" and kinds[-1] == b"IEND"
    samples = {0: 1, 2: 3, 6: 4}[colour]
    raw = zlib.decompress(body)
    stride = width * samples * bits // 8
    above, rows = bytearray(stride), []
    for row in range(height):
        start = row * (stride + 1)
        assert raw[start] == 2
        above = bytearray((raw[start + 1 + i] + above[i]) % 256 for i in range(stride))
        rows.append(bytes(above))
    values = np.frombuffer(b"".join(rows), ">u2" if bits == 16 else "u1")
    return values.reshape((height, width) if samples == 1 else (height, width, samples))


shapes = st.tuples(st.integers(1, 9), st.integers(1, 9))


@settings(max_examples=40, deadline=None)
@given(shapes, st.sampled_from([(), (3,), (4,)]), st.sampled_from([np.uint8, np.uint16]), st.integers(0, 2**32 - 1))
def test_png_keeps_every_sample(
    shape: tuple[int, int], samples: tuple[int, ...], kind: type[np.unsignedinteger], seed: int
) -> None:
    pixels = np.random.default_rng(seed).integers(0, np.iinfo(kind).max, (*shape, *samples), kind, endpoint=True)
    np.testing.assert_array_equal(decode_png(png.encode(pixels)), pixels)


def test_png_takes_reversed_rows_and_refuses_what_it_cannot_hold() -> None:
    pixels = np.arange(24, dtype=np.uint8).reshape(4, 2, 3)
    np.testing.assert_array_equal(decode_png(png.encode(pixels[::-1])), pixels[::-1])
    with pytest.raises(ValueError, match="cannot hold float64"):
        png.encode(np.zeros((2, 2)))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="shape"):
        png.encode(np.zeros((2, 2, 2), np.uint8))


def decode_exr(data: bytes) -> dict[str, NDArray[np.float32]]:
    """A ZIP or stored scan-line EXR of floats, by the file layout document."""
    assert struct.unpack_from("<II", data) == (20000630, 2)
    place, attributes = 8, {}
    while data[place]:
        name, kind, place = *_strings(data, place, 2), _after(data, place, 2)
        (size,) = struct.unpack_from("<I", data, place)
        attributes[name] = (kind, data[place + 4 : place + 4 + size])
        place += 4 + size
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names, channels = [], attributes["channels"][1]
    at = 0
    while channels[at]:
        names += _strings(channels, at, 1)
        at = _after(channels, at, 1) + 16
    result = {name: np.full((height, width), np.nan, np.float32) for name in names}
    count = -(-height // 16)
    for offset in struct.unpack_from(f"<{count}Q", data, place + 1):
        first, size = struct.unpack_from("<iI", data, offset)
        rows = min(16, height - first)
        stored = data[offset + 8 : offset + 8 + size]
        raw = stored if size == rows * width * 4 * len(names) else _unpacked(stored)
        values = np.frombuffer(raw, "<f4").reshape(rows, len(names), width)
        for index, name in enumerate(names):
            result[name][first : first + rows] = values[:, index]
    return result


def _strings(data: bytes, place: int, count: int) -> list[str]:
    return [part.decode() for part in data[place:].split(b"\0", count)[:count]]


def _after(data: bytes, place: int, count: int) -> int:
    return place + sum(len(part) + 1 for part in _strings(data, place, count))


def _unpacked(stored: bytes) -> bytes:
    differences = np.frombuffer(zlib.decompress(stored), np.uint8).astype(np.int64)
    differences[1:] -= 128
    split = (np.cumsum(differences) % 256).astype(np.uint8)
    data = np.empty_like(split)
    half = (len(split) + 1) // 2
    data[0::2], data[1::2] = split[:half], split[half:]
    return data.tobytes()


@settings(max_examples=30, deadline=None)
@given(st.tuples(st.integers(1, 40), st.integers(1, 9)), st.booleans(), st.integers(0, 2**32 - 1))
def test_exr_keeps_every_bit_noise_and_flat(shape: tuple[int, int], flat: bool, seed: int) -> None:
    random = np.random.default_rng(seed)
    channels = {
        name: np.full(shape, index, np.float32) if flat else random.standard_normal(shape).astype(np.float32)
        for index, name in enumerate("RGB")
    }
    channels["R"][0, 0] = np.inf
    read = decode_exr(exr.encode(channels))
    assert list(read) == ["B", "G", "R"]
    for name, values in channels.items():
        np.testing.assert_array_equal(read[name], values)


def test_npy_is_float32_for_floats_and_keeps_whole_numbers() -> None:
    depth = np.array([[1.5, np.inf]])
    read = np.load(io.BytesIO(npy.encode(depth)))
    assert read.dtype == np.float32
    np.testing.assert_array_equal(read, depth)
    assert np.load(io.BytesIO(npy.encode(np.arange(3, dtype=np.int32)))).dtype == np.int32
