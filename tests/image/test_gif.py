"""GIFs, read back by Pillow: another's decoder."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageSequence

from sdfc.image.gif import Gif, quantised
from sdfc.image.write import OutputError

Pictures = list[np.ndarray]


def film(pictures: Pictures, fps: float = 25.0) -> bytes:
    height, width = pictures[0].shape[:2]
    gif = Gif((width, height), fps)
    for picture in pictures:
        gif.add(picture)
    return gif.finish()


def decoded(data: bytes) -> tuple[Pictures, list[float]]:
    """Every frame as it is shown, and how long, in milliseconds."""
    opened = Image.open(io.BytesIO(data))
    shown = [
        (np.asarray(frame.convert("RGB")), float(frame.info["duration"])) for frame in ImageSequence.Iterator(opened)
    ]
    return [picture for picture, _ in shown], [duration for _, duration in shown]


def noise(seed: int, colours: int, shape: tuple[int, int], count: int) -> Pictures:
    random = np.random.default_rng(seed)
    palette = random.integers(0, 256, (colours, 3), np.uint8)
    return [palette[random.integers(0, colours, shape)] for _ in range(count)]


@given(st.integers(0, 999), st.integers(1, 255), st.integers(1, 90), st.integers(1, 90), st.integers(1, 3))
def test_few_colours_are_kept_exactly(seed: int, colours: int, width: int, height: int, count: int) -> None:
    pictures = noise(seed, colours, (height, width), count)
    shown, _ = decoded(film(pictures))
    assert len(shown) == count
    for made, wanted in zip(shown, pictures, strict=True):
        np.testing.assert_array_equal(made, wanted)


@pytest.mark.parametrize("colours", [2, 16, 255])
def test_tables_of_codes_that_overflow_many_times(colours: int) -> None:
    (picture,) = noise(1, colours, (300, 400), 1)
    ((shown,), _) = decoded(film([picture]))
    np.testing.assert_array_equal(shown, picture)


def test_many_colours_come_near_and_still_ones_stay_as_they_are() -> None:
    y, x = np.mgrid[0:128, 0:128]
    first = np.stack([x * 2, y * 2, 255 - x - y], axis=-1).astype(np.uint8)
    second = first.copy()
    second[40:50, 60:90] = 7, 200, 9
    (one, two), _ = decoded(film([first, second]))
    assert np.abs(one.astype(int) - first).mean() < 5.0
    still = (first == second).all(axis=2)
    np.testing.assert_array_equal(two[still], one[still])
    np.testing.assert_array_equal(two[~still], second[~still])


def test_only_what_changed_is_stored() -> None:
    first = noise(3, 200, (128, 128), 1)[0]
    second = first.copy()
    second[5, 6] ^= 1
    assert len(film([first, second])) - len(film([first])) < 100


@given(st.integers(0, 999), st.integers(256, 4000))
def test_every_colour_goes_to_one_of_at_most_255(seed: int, count: int) -> None:
    colours = np.random.default_rng(seed).integers(0, 256, (count, 3), np.uint8)
    palette, indices = quantised(colours)
    assert len(palette) <= 255 and indices.max() < len(palette)
    error = (palette[indices].astype(float) - colours) ** 2
    assert error.sum() < 0.1 * ((colours.mean(axis=0) - colours) ** 2).sum()


@pytest.mark.parametrize("fps", [7.0, 24.0, 30.0, 50.0])
def test_delays_are_right_in_the_sum(fps: float) -> None:
    pictures = [np.full((4, 4, 3), n, np.uint8) for n in range(31)]
    shown, durations = decoded(film(pictures, fps))
    assert len(shown) == 31
    assert sum(durations) == pytest.approx(31_000 / fps, abs=5.001)
    assert max(durations) - min(durations) <= 10


def test_what_is_too_fast_is_refused() -> None:
    with pytest.raises(OutputError, match="at most 50 frames a second"):
        Gif((4, 4), 60.0)


def test_it_repeats_for_ever() -> None:
    pictures = [np.full((2, 2, 3), level, np.uint8) for level in (0, 9)]
    assert Image.open(io.BytesIO(film(pictures))).info["loop"] == 0
