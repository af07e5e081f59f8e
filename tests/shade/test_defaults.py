"""The light of a scene that names none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sdfc.shade.defaults import SKY, SUN_HEIGHT, key_sun

coordinate = st.floats(-1e4, 1e4)
points = st.tuples(coordinate, coordinate, coordinate)


@given(eye=points, target=points, up=st.sampled_from([(0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -2.0)]))
def test_the_sun_stands_at_its_height_for_every_camera(
    eye: tuple[float, float, float], target: tuple[float, float, float], up: tuple[float, float, float]
) -> None:
    direction = np.array(key_sun(eye, target, up).direction)
    assert math.hypot(*direction) == pytest.approx(1.0)
    assert -direction @ np.array(up) / math.hypot(*up) == pytest.approx(math.sin(SUN_HEIGHT), abs=1e-6)


@pytest.mark.parametrize(
    ("eye", "up", "right"),
    [
        ((0.0, 1.0, 5.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)),
        ((5.0, 1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
        ((0.0, -5.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    ],
)
def test_the_sun_is_behind_the_viewer_on_the_left(
    eye: tuple[float, float, float], up: tuple[float, float, float], right: tuple[float, float, float]
) -> None:
    toward = -np.array(key_sun(eye, (0.0, 0.0, 0.0), up).direction)
    assert toward @ np.array(right) < -0.3
    assert toward @ np.array(eye) > 0.3


def test_the_default_sky_is_brightest_at_the_horizon() -> None:
    assert min(SKY.horizon) > max(SKY.zenith) > max(SKY.ground)
