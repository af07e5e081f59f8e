"""The BRDF: energy, reciprocity, finite everywhere; and its fitted integrals against quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from evaluate import UP, hemisphere, run, unit
from hypothesis import given
from hypothesis import strategies as st

unit_interval = st.floats(0.0, 1.0)
components = st.floats(-1.0, 1.0)
directions = st.tuples(components, components, components).filter(lambda v: np.linalg.norm(v) > 1e-3).map(unit)
colors = st.tuples(unit_interval, unit_interval, unit_interval).map(np.array)


def tilted(cosine: float) -> np.ndarray:
    return np.array([np.sqrt(1.0 - cosine * cosine), cosine, 0.0])


def lights(view: np.ndarray, roughness: float, count: int = 300) -> tuple[np.ndarray, np.ndarray]:
    """Light directions with weights (solid angles): half by GGX's own lobe for this view, half uniform.

    The balance heuristic (Veach 1995) joins both, so that a narrow highlight is integrated well.
    """
    alpha = max(roughness, 0.09) ** 2
    i = np.arange(count * count)
    u, angle = (i // count + 0.5) / count, 2.0 * np.pi * (i % count + 0.5) / count
    height = np.sqrt((1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u))
    flat = np.sqrt(1.0 - height * height)
    half = np.stack([flat * np.cos(angle), height, flat * np.sin(angle)])
    mirrored = 2.0 * (view @ half) * half - view[:, None]
    even, _ = hemisphere(count)
    both = np.concatenate([mirrored, even], axis=1)
    between = unit(both + view[:, None])
    spread = alpha * alpha / (np.pi * (between[1] ** 2 * (alpha * alpha - 1.0) + 1.0) ** 2)
    density = spread * np.abs(between[1]) / (4.0 * np.abs(view @ between))
    weight = 1.0 / (count * count * (density + 1.0 / (2.0 * np.pi)))
    return both, np.where(both[1] > 0.0, weight, 0.0)


def albedo(cosine: float, roughness: float, metallic: float, color: float = 1.0) -> float:
    view = tilted(cosine)
    toward, weights = lights(view, roughness)
    look = {"color": np.full(3, color), "metallic": metallic, "roughness": roughness}
    sent = run("reflect_light", normal=UP, view=view, light=toward, **look)
    return float(np.sum(sent[0] * weights))


@pytest.mark.parametrize("roughness", [0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 0.5, 1.0])
def test_no_more_light_leaves_than_came(roughness: float, metallic: float) -> None:
    found = [albedo(cosine, roughness, metallic) for cosine in (0.05, 0.2, 0.5, 0.8, 1.0)]
    assert max(found) < 1.05, found


@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.7, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_a_white_surface_loses_almost_nothing(roughness: float, metallic: float) -> None:
    """The furnace test: without the light between facets a rough mirror would lose more than half."""
    found = [albedo(cosine, roughness, metallic) for cosine in (0.3, 0.6, 1.0)]
    assert min(found) > 0.93, found


@given(view=directions, light=directions, color=colors, metallic=unit_interval, roughness=unit_interval)
def test_light_and_view_may_change_places(
    view: np.ndarray, light: np.ndarray, color: np.ndarray, metallic: float, roughness: float
) -> None:
    view, light = (v * np.array([1.0, np.sign(v[1]) or 1.0, 1.0]) for v in (view, light))
    if min(view[1], light[1]) < 1e-3:
        return
    look = {"color": color, "metallic": metallic, "roughness": roughness}
    there = run("reflect_light", normal=UP, view=view, light=light, **look) / light[1]
    back = run("reflect_light", normal=UP, view=light, light=view, **look) / view[1]
    assert np.allclose(there, back, rtol=1e-6, atol=1e-9)


@given(
    normal=directions, view=directions, light=directions, color=colors, metallic=unit_interval, roughness=unit_interval
)
def test_finite_and_not_negative_for_every_direction(
    normal: np.ndarray, view: np.ndarray, light: np.ndarray, color: np.ndarray, metallic: float, roughness: float
) -> None:
    look = {"color": color, "metallic": metallic, "roughness": roughness}
    for opposite in (view, light, -light, normal, -normal):
        sent = run("reflect_light", normal=normal, view=opposite, light=light, **look)
        assert np.all(np.isfinite(sent)) and np.all(sent >= 0.0)
        if normal @ light <= 0.0:
            assert np.all(sent == 0.0)


def test_a_mirror_reflects_most_in_the_mirror_direction() -> None:
    view = tilted(0.7)
    toward, _ = hemisphere(200)
    sent = run("reflect_light", normal=UP, view=view, light=toward, color=np.ones(3), metallic=1.0, roughness=0.15)
    brightest = toward[:, np.argmax(sent[0])]
    assert brightest @ (view * [-1.0, 1.0, -1.0]) > 0.998


def test_a_metal_tints_its_highlight_and_a_plastic_does_not() -> None:
    view, light = tilted(0.9), tilted(0.9) * [-1.0, 1.0, 1.0]
    look = {"normal": UP, "view": view, "light": light, "color": np.array([1.0, 0.5, 0.0]), "roughness": 0.1}
    metal = run("reflect_light", metallic=1.0, **look)[:, 0]
    plastic = run("reflect_light", metallic=0.0, **look)[:, 0]
    assert metal[2] < 0.01 * metal[0]
    assert plastic[2] > 0.9 * plastic[0]


@given(offset=st.tuples(*[st.floats(-1e6, 1e6)] * 3).map(np.array))
def test_a_point_light_falls_with_the_square(offset: np.ndarray) -> None:
    found = float(np.ravel(run("point_falloff", offset=offset))[0])
    squared = float(offset @ offset)
    assert found == pytest.approx(1.0 / max(squared, 1e-8))
