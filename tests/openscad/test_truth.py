"""Every fixture against OpenSCAD itself: points that its mesh says are inside or outside (made by make_truth.py)."""

from pathlib import Path

import numpy as np
import pytest

from sdfc.diagnostics import Source
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.openscad.load import load
from sdfc.shape.lower import lower

MODELS = Path(__file__).parent / "models"
NAMES = sorted(path.stem for path in MODELS.glob("*.csg"))


@pytest.mark.parametrize("name", NAMES)
def test_inside_is_inside(name: str) -> None:
    rows = np.loadtxt(MODELS / f"{name}.points")
    assert len(rows) >= 100
    scene = load(Source(f"{name}.csg", (MODELS / f"{name}.csg").read_text()))
    p = scene.values.input("p", Type.VEC3)
    (distance,) = Evaluator([lower(scene.root, p)])({"p": rows[:, :3].T})
    wrong = (distance < 0.0) != (rows[:, 3] > 0.5)
    assert not wrong.any(), [(*row, d) for row, d in zip(rows[wrong], distance[wrong], strict=True)][:5]
