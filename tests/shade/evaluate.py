"""Shading functions as NumPy functions of arrays, for this folder's tests."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sdfc.field.function import Function
from sdfc.field.graph import FieldGraph
from sdfc.field.numeric import Evaluator
from sdfc.shade.functions import FUNCTIONS

Array = NDArray[np.float64]

UP = np.array([0.0, 1.0, 0.0])
SKY = {
    "up": UP,
    "zenith": np.array([0.2, 0.35, 0.7]),
    "horizon": np.array([0.9, 0.85, 0.8]),
    "ground": np.array([0.3, 0.25, 0.2]),
}


@cache
def function(name: str) -> Function:
    return FUNCTIONS[name](FieldGraph())


@cache
def _evaluator(name: str) -> Evaluator:
    return Evaluator([function(name).result])


def run(name: str, **inputs: Any) -> Array:
    """The function's value, float64; (k,) inputs are the same at all points."""
    types = dict(function(name).parameters)
    given = {
        parameter: np.reshape(value, (3, 1)) if types[parameter].size == 3 and np.ndim(value) == 1 else value
        for parameter, value in inputs.items()
    }
    return _evaluator(name)(given)[0]


def unit(v: Any) -> Array:
    v = np.asarray(v, float)
    return v / np.sqrt(np.sum(v * v, axis=0))


def hemisphere(count: int) -> tuple[Array, Array]:
    """Unit directions (3, count²) around +y and the solid angle of each: uniform in height and angle."""
    i = np.arange(count * count)
    height = (i // count + 0.5) / count
    angle = 2.0 * np.pi * (i % count + 0.5) / count
    flat = np.sqrt(1.0 - height * height)
    return np.stack([flat * np.cos(angle), height, flat * np.sin(angle)]), np.full(i.shape, 2.0 * np.pi / count**2)
