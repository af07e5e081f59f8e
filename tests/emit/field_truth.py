"""An emitted field in float64: the step tree folded over the formulas as NumPy evaluates them."""

from __future__ import annotations

from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sdfc.pipeline import Compiled
from sdfc.plan.steps import All, Any, Ball, Blend, Chord, Closed, Many, Part, Step, Tangent, Within, may_flatten
from sdfc.reference.formulas import Formulas
from sdfc.shape.lower import FAR

Array = NDArray[np.float64]


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
                    return np.where(box > 1e-3 * step.box.radius, box, value)
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
