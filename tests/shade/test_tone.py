"""Tone mapping and encoding: bounded, monotone, neutral greys; and `present`."""

from __future__ import annotations

import numpy as np
import pytest
from evaluate import run
from hypothesis import given
from hypothesis import strategies as st

from sdfc.shade.present import present

radiances = st.floats(0.0, 1e6)
colors = st.tuples(radiances, radiances, radiances).map(np.array)


def display(color: np.ndarray) -> np.ndarray:
    return run("encode_srgb", color=run("tone_map", color=color))


@given(color=colors)
def test_every_radiance_can_be_shown(color: np.ndarray) -> None:
    shown = display(color)
    assert np.all(np.isfinite(shown)) and np.all(shown >= 0.0) and np.all(shown <= 1.0)


@given(color=colors, channel=st.integers(0, 2), more=st.floats(1.0, 100.0))
def test_more_light_in_a_channel_never_shows_less(color: np.ndarray, channel: int, more: float) -> None:
    brighter = color.copy()
    brighter[channel] = color[channel] * more + 1e-4 * (more - 1.0)
    before, after = (run("tone_map", color=c)[channel, 0] for c in (color, brighter))
    assert after >= before - 1e-3  # a row of OUTSET sums to a little less than 1


def test_greys_stay_grey_and_rise() -> None:
    greys = np.repeat(np.geomspace(1e-4, 100.0, 400)[None], 3, axis=0)
    shown = display(greys)
    assert np.abs(shown - shown[:1]).max() < 2e-3
    assert np.all(np.diff(shown[0]) >= 0.0)
    assert shown[0, 0] < 0.01 and shown[0, -1] > 0.99


def test_a_mid_grey_is_shown_as_one() -> None:
    assert 0.38 < display(np.full((3, 1), 0.18))[0, 0] < 0.5


def test_encoding_is_srgb() -> None:
    """At both ends, at the joint of its pieces, and at a value of the standard's table."""
    linear = np.array([0.0, 0.0031308, 0.21586, 1.0])
    encoded = run("encode_srgb", color=np.repeat(linear[None], 3, axis=0))[1]
    assert encoded == pytest.approx([0.0, 0.04045, 0.50196, 1.0], abs=2e-5)


def test_present_is_what_the_functions_say() -> None:
    radiance = np.random.default_rng(1).gamma(1.0, 0.5, (20, 30, 3))
    exact = display(radiance.reshape(-1, 3).T).T.reshape(radiance.shape)
    shown = present(radiance)
    assert shown.dtype == np.uint8
    assert np.abs(shown - 255.0 * exact).max() < 0.51


def test_present_shows_black_for_what_is_no_number() -> None:
    radiance = np.zeros((1, 2, 3))
    radiance[0, 0] = np.nan
    assert present(radiance)[0, 0].tolist() == [0, 0, 0]
