"""Every scene in scenes/, and every model in ../shared/models where there is one, loads, compiles and is seen."""

from __future__ import annotations

import math
from pathlib import Path

import moderngl
import numpy as np
import pytest

import sdfc
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.shape.lower import lower

ROOT = Path(__file__).parent.parent
SCENES = sorted(p for p in (ROOT / "scenes").iterdir() if p.suffix in (".sdf", ".csg"))
MODELS = sorted((ROOT.parent / "shared" / "models").glob("*.csg"))
ALL = SCENES + MODELS
SIZE = (64, 36)


def name(path: Path) -> str:
    return path.name


def test_there_are_enough() -> None:
    assert len([p for p in SCENES if p.suffix == ".sdf"]) >= 12
    assert len([p for p in SCENES if p.suffix == ".csg"]) >= 3


@pytest.mark.parametrize("path", SCENES, ids=name)
def test_no_warnings(path: Path) -> None:
    assert sdfc.compile(path).warnings == ()


@pytest.mark.parametrize("path", [p for p in SCENES if p.suffix == ".sdf"], ids=name)
def test_it_says_what_it_is(path: Path) -> None:
    assert path.read_text().startswith("// ")
    assert sdfc.compile(path).scene.camera is not None


@pytest.mark.gpu
@pytest.mark.parametrize("path", ALL, ids=name)
def test_it_is_seen(path: Path, gl: moderngl.Context) -> None:
    """The camera shows a subject: it fills a fair part of the picture, is not one flat thing, and has colours."""
    with sdfc.compile(path) as program:
        image = program.render(SIZE, aovs=("depth", "normal"), backend="gl")
    hit = np.isfinite(image.depth)
    assert hit.mean() > 0.03
    assert np.isfinite(image.colour).all()
    assert np.allclose(np.linalg.norm(image.normal[hit], axis=-1), 1.0, atol=1e-3)
    facing = np.abs(image.normal[hit]).max(axis=-1)
    assert facing.std() > 0.001 or len(np.unique(image.normal[hit].round(2), axis=0)) >= 3
    assert image.pixels.reshape(-1, 3).std(axis=0).max() > 5.0


def test_csg5_is_the_scene_that_is_measured() -> None:
    scene = sdfc.compile(ROOT / "scenes" / "csg5.sdf").scene
    points = np.random.default_rng(5).uniform(-1.2, 1.2, (3, 4000))
    box = np.abs(points).max(axis=0) - 0.8
    sphere = np.linalg.norm(points, axis=0) - 1.05
    inside = (box <= 0) & (sphere <= 0)
    for axis in range(3):
        across = np.linalg.norm(np.delete(points, axis, axis=0), axis=0) - 0.5
        inside &= np.maximum(across, np.abs(points[axis]) - 1.5) > 0
    p = scene.values.input("p", Type.VEC3)
    (distance,) = Evaluator([lower(scene.root, p)])({"p": points}, {})
    assert ((distance <= 0) == inside).all()
    camera = scene.camera
    assert camera is not None
    assert camera.eye.numbers == (3.0, 2.4, 3.6)
    assert camera.target.numbers == (0.0, 0.0, 0.0)
    assert camera.fov.number == pytest.approx(2 * math.atan(1 / 3.6), rel=1e-12)


def test_the_table_has_300_spheres() -> None:
    rows = (ROOT / "scenes" / "spheres.csv").read_text().splitlines()
    assert rows[0] == "x,y,z,r,arm"
    assert len(rows) == 301
