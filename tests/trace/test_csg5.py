"""The scene that the project is measured on, at full size: exact to rounding, wherever it is put and however large."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from closed_truth import closed_truth
from truth import THIN, Picture, Tracing, compiled_text, every

from sdfc.api.request import View

pytestmark = pytest.mark.gpu

SIZE = (1280, 720)
TEXT = (Path(__file__).parent.parent.parent / "scenes" / "csg5.sdf").read_text()
NEAR = 2.0**-20  # of the scene's radius: what is contested


def moved(factor: float, by: tuple[float, float, float]) -> tuple[str, View]:
    """The scene scaled and moved, and its camera with it."""
    head, body = TEXT.split("scene {", 1)
    solid = body.rsplit("}", 1)[0]
    x, y, z = by
    text = f"{head}scene {{ union {{ {solid} }}.scale({factor}).translate([{x}, {y}, {z}]) }}"
    eye = (3.0 * factor + x, 2.4 * factor + y, 3.6 * factor + z)
    return text, View(eye=eye, target=by, up=(0.0, 1.0, 0.0), fov=2.0 * math.atan(1.0 / 3.6))


def drawn(tracing: Tracing, factor: float, by: tuple[float, float, float]) -> tuple[Picture, float]:
    text, view = moved(factor, by)
    compiled = compiled_text(text)
    return tracing.picture(compiled, SIZE, view), compiled.frame.radius


@pytest.fixture(scope="module")
def plain(tracing: Tracing) -> Picture:
    return drawn(tracing, 1.0, (0.0, 0.0, 0.0))[0]


def distance(p: np.ndarray) -> np.ndarray:
    """The scene's, by hand, float64."""
    q = np.abs(p) - 0.8
    box = np.linalg.norm(np.maximum(q, 0.0), axis=0) + np.minimum(q.max(axis=0), 0.0)
    ball = np.linalg.norm(p, axis=0) - 1.05
    bores = [np.hypot(p[(axis + 1) % 3], p[(axis + 2) % 3]) - 0.5 for axis in range(3)]
    return np.maximum.reduce([box, ball, *(-bore for bore in bores)])


def test_nothing_missed_and_nothing_invented(plain: Picture, is_full: bool) -> None:
    compiled = compiled_text(moved(1.0, (0.0, 0.0, 0.0))[0])
    picture = plain if is_full else every(plain, 40_000)
    truth = closed_truth(compiled, picture.o, picture.d, NEAR, THIN)
    sure = ~truth.contested
    both = sure & truth.hit & picture.hit
    error = np.abs(picture.depth - truth.t)[both]
    spread = f"|dt| median {np.median(error):.1e}, max {error.max():.1e}"
    print(f"csg5: {both.sum()} hits, {(~sure).sum()} contested, {spread}")
    assert (sure & (truth.hit != picture.hit)).sum() == 0
    assert (~sure).sum() < 200
    assert np.median(error) < 2e-7
    residual = np.abs(distance(plain.points * compiled.frame.radius + np.array(compiled.frame.centre)[:, None]))
    assert residual.max() < 5e-6 * compiled.frame.radius


@pytest.mark.parametrize(
    ("factor", "by"),
    [(0.01, (0, 0, 0)), (100.0, (0, 0, 0)), (1.0, (1e5, 0, 0)), (1.0, (1e5, -1e5, 3e4)), (1e-4, (7, 8, 9))],
    ids=str,
)
def test_neither_place_nor_size_matters(
    factor: float, by: tuple[float, float, float], tracing: Tracing, plain: Picture
) -> None:
    picture, _ = drawn(tracing, factor, by)
    changed = (picture.hit != plain.hit).sum()
    both = picture.hit & plain.hit
    off = np.abs(picture.depth - plain.depth)[both]
    # a moved centre is rounded in float64: the rays are not the very same, and a few graze another way
    assert changed <= (0 if by == (0, 0, 0) else 4), f"{changed} pixels changed"
    assert np.quantile(off, 0.999) < 3e-6
    assert (off > 1e-4).sum() <= 20
