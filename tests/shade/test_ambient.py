"""The sky, its light on surfaces, glass, and how hollows are darker."""

from __future__ import annotations

import numpy as np
import pytest
from evaluate import SKY, UP, hemisphere, run, unit
from hypothesis import given
from hypothesis import strategies as st

from sdfc.shade.ambient import OCCLUSION_HEIGHTS, OCCLUSION_WEIGHTS
from sdfc.shade.sky import GROUND_UNDER_COSINE, ZENITH_UNDER_COSINE

unit_interval = st.floats(0.0, 1.0)
components = st.floats(-1.0, 1.0)
directions = st.tuples(components, components, components).filter(lambda v: np.linalg.norm(v) > 1e-3).map(unit)
colors = st.tuples(unit_interval, unit_interval, unit_interval).map(np.array)
HEIGHTS = np.array(OCCLUSION_HEIGHTS)


def openness(distances: np.ndarray) -> float:
    columns = {"distances": np.reshape(distances, (4, 1)), "heights": HEIGHTS.reshape(4, 1)}
    return float(run("occlusion_weight", **columns)[0])


def test_the_sky_is_its_colours_at_the_zenith_the_horizon_and_below() -> None:
    above = run("sky_radiance", direction=np.array([0.0, 1.0, 0.0]), **SKY)[:, 0]
    level = run("sky_radiance", direction=np.array([1.0, 0.0, 0.0]), **SKY)[:, 0]
    below = run("sky_radiance", direction=np.array([0.0, -1.0, 0.0]), **SKY)[:, 0]
    assert np.allclose(above, SKY["zenith"], atol=0.03)
    assert np.allclose(level, SKY["horizon"], atol=0.06)
    assert np.allclose(below, SKY["ground"], atol=0.03)


def test_the_sky_has_no_seam() -> None:
    height = np.linspace(-1.0, 1.0, 4001)
    direction = np.stack([np.sqrt(1.0 - height**2), height, np.zeros_like(height)])
    steps = np.abs(np.diff(run("sky_radiance", direction=direction, **SKY), axis=1))
    assert steps.max() < 5e-3
    assert np.abs(np.diff(steps, axis=1)).max() < 2e-4


@pytest.mark.parametrize("height", [-1.0, -0.7, -0.3, 0.0, 0.4, 0.8, 1.0])
def test_the_mean_under_a_cosine_is_the_integral(height: float) -> None:
    """Each colour alone is a probe of its weight."""
    axis = np.array([np.sqrt(1.0 - height**2), height, 0.0])
    across = np.array([-height, axis[0], 0.0])
    around, solid_angle = hemisphere(250)
    turned = around[0] * across[:, None] + around[1] * axis[:, None] + around[2] * np.array([[0.0], [0.0], [1.0]])
    weights = around[1] * solid_angle / np.pi
    for color, coefficients in (("zenith", ZENITH_UNDER_COSINE), ("ground", GROUND_UNDER_COSINE)):
        sky = {name: np.full(3, float(name == color)) for name in ("zenith", "horizon", "ground")}
        integral = np.sum(run("sky_radiance", direction=turned, up=UP, **sky)[0] * weights)
        assert np.polynomial.polynomial.polyval(height, coefficients) == pytest.approx(integral, abs=0.004)


def test_white_under_a_white_sky_is_white() -> None:
    """A furnace: nothing is made, little is lost."""
    white = {"up": UP, "zenith": np.ones(3), "horizon": np.ones(3), "ground": np.ones(3)}
    for cosine in (0.2, 0.5, 1.0):
        view = np.array([np.sqrt(1.0 - cosine**2), cosine, 0.0])
        for roughness in (0.1, 0.5, 1.0):
            for metallic in (0.0, 1.0):
                look = {"color": np.ones(3), "metallic": metallic, "roughness": roughness, "occlusion": 1.0}
                found = run("ambient", normal=UP, view=view, **look, **white)
                assert found.min() > 0.95 and found.max() < 1.03


@given(
    normal=directions,
    view=directions,
    color=colors,
    metallic=unit_interval,
    roughness=unit_interval,
    open_=unit_interval,
)
def test_ambient_is_finite_and_not_more_than_the_sky(
    normal: np.ndarray, view: np.ndarray, color: np.ndarray, metallic: float, roughness: float, open_: float
) -> None:
    look = {"color": color, "metallic": metallic, "roughness": roughness}
    found = run("ambient", normal=normal, view=view, occlusion=open_, **look, **SKY)
    assert np.all(np.isfinite(found)) and np.all(found >= 0.0)
    brightest = max(float(np.max(SKY[name])) for name in ("zenith", "horizon", "ground"))
    assert found.max() <= 1.05 * brightest
    assert np.all(found <= run("ambient", normal=normal, view=view, occlusion=1.0, **look, **SKY) + 1e-9)


@given(normal=directions, view=directions, ior=st.floats(1.0, 4.0), tint=colors)
def test_glass_is_finite_and_not_brighter_than_the_sky(
    normal: np.ndarray, view: np.ndarray, ior: float, tint: np.ndarray
) -> None:
    found = run("transmit", normal=normal, view=view, ior=ior, tint=tint, **SKY)
    assert np.all(np.isfinite(found)) and np.all(found >= 0.0)
    assert found.max() <= 1.0


def test_glass_of_index_one_is_air() -> None:
    view = unit([0.3, -0.5, 1.0])
    found = run("transmit", normal=np.array([0.0, 0.0, 1.0]), view=view, ior=1.0, tint=np.ones(3), **SKY)
    assert np.allclose(found, run("sky_radiance", direction=-view, **SKY), atol=1e-3)


def test_glass_turns_the_sky_over() -> None:
    """Through the lower half of a ball of glass one sees the sky above."""
    view = np.array([0.0, 0.0, 1.0])
    look = {"view": view, "ior": 1.52, "tint": np.ones(3), **SKY}
    upper, lower = (run("transmit", normal=unit([0.0, y, 0.5]), **look)[2, 0] for y in (0.6, -0.6))
    assert lower > upper  # the sky is bluer than the ground


def test_a_plane_is_open_and_a_slit_is_not() -> None:
    assert openness(HEIGHTS) == pytest.approx(1.0)
    assert openness(0.0 * HEIGHTS) < 0.2
    assert openness(-HEIGHTS) < 0.2
    assert sum(OCCLUSION_WEIGHTS) == pytest.approx(1.0)


def test_a_plane_in_a_field_that_is_a_lower_bound_is_still_open() -> None:
    assert openness(0.5 * HEIGHTS) == pytest.approx(1.0)
    assert openness(0.3 * HEIGHTS) == pytest.approx(1.0)


def test_a_wall_darkens_more_the_nearer_it_is() -> None:
    near = [openness(np.minimum(HEIGHTS, distance)) for distance in np.linspace(0.0, 0.3, 100)]
    assert np.all(np.diff(near) >= -1e-12)
    assert near[0] < 0.3 and near[-1] == pytest.approx(1.0)


@given(distances=st.tuples(*[st.floats(-1e3, 1e9)] * 4).map(np.array))
def test_occlusion_stays_in_range(distances: np.ndarray) -> None:
    assert 0.0 <= openness(distances) <= 1.0


@given(direction=directions, toward=directions)
def test_the_sun_is_a_small_disc(direction: np.ndarray, toward: np.ndarray) -> None:
    share = float(np.ravel(run("sun_disc", direction=direction, toward=toward))[0])
    assert 0.0 <= share <= 1.0
    if direction @ toward < np.cos(np.radians(3.0)):
        assert share < 0.02
    assert float(np.ravel(run("sun_disc", direction=toward, toward=toward))[0]) == 1.0


@given(distances=st.tuples(*[st.floats(-1e3, 1e9)] * 4).map(np.array))
def test_nothing_farther_than_a_tap_is_high_hides_anything(distances: np.ndarray) -> None:
    """So the parts of a table that are farther need not be met."""
    assert openness(np.minimum(distances, HEIGHTS)) == openness(distances)
