"""An emitted field in float64: the step tree folded over the formulas as NumPy evaluates them."""

from __future__ import annotations

from functools import cache
from typing import assert_never

import numpy as np
from emitting import program
from numpy.typing import NDArray

from sdfc.pipeline import Compiled, Options
from sdfc.plan.steps import All, Any, Ball, Blend, Chord, Closed, Many, Part, Step, Tangent, Within, may_flatten
from sdfc.reference.formulas import Formulas
from sdfc.shape.lower import FAR

Array = NDArray[np.float64]
POINTS = 4000


@cache
def compiled_field(scene: str) -> Compiled:
    """The scene as the field part is made from it."""
    return program(scene).compiled_as(Options(tracer="sphere", field=True, own_unit=False))


def points_near(compiled: Compiled, seed: int) -> NDArray[np.float32]:
    """(3, POINTS): in the scene's box and around it, in the scene's units."""
    low, high = np.array(compiled.frame.box.lo), np.array(compiled.frame.box.hi)
    middle, half = 0.5 * (low + high), 0.5 * (high - low) + 0.05 * np.linalg.norm(high - low)
    given = np.random.default_rng(seed).uniform(-1.3, 1.3, (3, POINTS))
    return (middle[:, None] + half[:, None] * given).astype(np.float32)


def agreement(compiled: Compiled, points: NDArray[np.float32], made: NDArray[np.floating]) -> float:
    """By how much of the scene's size what was made (n,) at the points (3, n) is off, at most."""
    frame = compiled.frame
    own = (points.astype(np.float64) - np.array(frame.centre)[:, None]) / frame.radius
    size = float(np.linalg.norm(np.array(frame.box.hi) - np.array(frame.box.lo)))
    exact = np.clip(FieldTruth(compiled)(own) * frame.radius, -1e9, 1e9)
    return float(np.abs(made - exact).max()) / size


class FieldTruth:
    """The distance bound of a compiled scene, in its own coordinates."""

    def __init__(self, compiled: Compiled) -> None:
        params = {p.name: np.array(p.default)[:, None] if len(p.default) > 1 else np.array(p.default[0])
                  for p in compiled.scene.params}  # fmt: skip
        self._slopes = compiled.plan.slopes
        self._root = compiled.plan.root
        self._formulas = Formulas(compiled.scene.values, params, compiled.plan.materials, compiled.setting.unpainted)

    def __call__(self, p: Array) -> Array:
        """(n,) for p (3, n)."""
        return self._fold(self._root, p)

    def _fold(self, step: Step, p: Array) -> Array:
        match step:
            case Closed() | Ball():
                return self._value(step.part, p) * (1.0 if step.inside else -1.0)
            case Tangent() | Blend():
                return self._value(step.part, p)
            case Chord():
                return -self._value(step.part, p)
            case Many():
                return self._least([self._fold(m, p) for m in step.members], p)
            case Within():
                value, box = self._fold(step.step, p), _box(step, p)
                if step.is_needed:
                    margin = 1e-3 * step.box.radius
                    return np.where(box > margin, box, np.maximum(box, np.minimum(value, 2.0 * margin - box)))
                return np.maximum(value, box) if may_flatten(step) else value
            case Any():
                return self._least([self._fold(s, p) for s in step.steps], p)
            case All():
                return -self._least([-self._fold(s, p) for s in step.steps], p)
            case _:
                assert_never(step)

    def _least(self, values: list[Array], p: Array) -> Array:
        return np.min(values, axis=0) if values else np.full(p.shape[1], FAR)

    def _value(self, part: Part, p: Array) -> Array:
        return self._formulas.value(part, p) / max(self._slopes[id(part)], 1e-9)


def _box(step: Within, p: Array) -> Array:
    q = np.abs(p - np.array(step.box.centre)[:, None]) - np.array(step.box.half)[:, None]
    return np.linalg.norm(np.maximum(q, 0.0), axis=0) + np.minimum(q.max(axis=0), 0.0)
