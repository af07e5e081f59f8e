"""What the tests ask of a `.csg` text: the distance at points, and what was said about it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sdfc.diagnostics import Diagnostic, SceneError, Source, show
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.openscad.load import load
from sdfc.scene.model import Scene
from sdfc.shape.lower import lower


def scene(text: str) -> Scene:
    return load(Source("m.csg", text))


def distance(text: str, points: Sequence[Sequence[float]]) -> np.ndarray:
    """The field of the whole file, at points."""
    made = scene(text)
    p = made.values.input("p", Type.VEC3)
    rows = np.asarray(points, dtype=float).T
    (values,) = Evaluator([lower(made.root, p)])({"p": rows})
    return np.broadcast_to(values, rows.shape[1:])


def inside(text: str, *points: Sequence[float]) -> list[bool]:
    return [bool(d < 0.0) for d in distance(text, points)]


def refusal(text: str) -> str:
    """The one error of a text, as shown."""
    try:
        scene(text)
    except SceneError as error:
        (diagnostic,) = error.diagnostics
        assert isinstance(diagnostic, Diagnostic)
        assert diagnostic.span is not None
        return show(diagnostic)
    raise AssertionError("no error")
