"""Affine maps on their way to the leaves: plain numbers as long as they can be, for scenes of thousands of parts."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TypeAlias

from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.graph import Affine
from sdfc.shape.matrix import Linear, Matrix, Numbers, composed, scaling
from sdfc.shape.stretch import is_similarity, scale_of, smallest_stretch


@dataclass(frozen=True, slots=True, eq=False)
class Fixed:
    """A constant map and its inverse."""

    forward: Numbers
    inverse: Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Live:
    """A map that a param changes, and its inverse."""

    forward: Matrix
    inverse: Matrix


Motion: TypeAlias = Fixed | Live
_IDENTITY: Numbers = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
NOWHERE = Fixed(_IDENTITY, _IDENTITY)


def is_nowhere(motion: Motion) -> bool:
    match motion:
        case Fixed():
            return motion is NOWHERE or (motion.forward == _IDENTITY and motion.inverse == _IDENTITY)
        case Live():
            return False


class Motions:
    """Composes motions, equal ones once; makes matrices of one field graph. Most maps turn alike, if at all: what is
    made of a linear part is remembered."""

    def __init__(self, values: FieldGraph) -> None:
        self._values = values
        self._fixed = {(NOWHERE.forward, NOWHERE.inverse): NOWHERE}
        self._live: dict[tuple[tuple[Expr, ...], tuple[Expr, ...]], Live] = {}
        self._scales: dict[tuple[Numbers, int], float | None] = {}
        self._unscaled: dict[tuple[Numbers, Numbers, float, int], tuple[Numbers, Numbers]] = {}
        self._linears: dict[Numbers, Linear] = {}

    def after(self, outer: Motion, inner: Affine) -> Motion:
        """`inner`'s map, then `outer`."""
        there, back = inner.forward.numbers, inner.inverse.numbers
        match outer:
            case Fixed() if there is not None and back is not None:
                if outer is NOWHERE:
                    return self._as_fixed(there, back)
                return self._as_fixed(composed(outer.forward, there), composed(back, outer.inverse))
            case _:
                forward, inverse = self.matrices(outer)
                return self._as_live(forward.after(inner.forward), inner.inverse.after(inverse))

    def matrices(self, motion: Motion) -> tuple[Matrix, Matrix]:
        """The map and its inverse."""
        match motion:
            case Live():
                return motion.forward, motion.inverse
            case Fixed():
                return self._matrix(motion.forward), self._matrix(motion.inverse)

    def scale(self, motion: Motion, dimension: int) -> float | None:
        """The factor by which it stretches all directions, where that is one number."""
        match motion:
            case Fixed():
                key = motion.forward[:9], dimension
                if key not in self._scales:
                    rows = [motion.forward[3 * i : 3 * i + dimension] for i in range(dimension)]
                    self._scales[key] = scale_of(rows)
                return self._scales[key]
            case Live():
                if not is_similarity(motion.forward, dimension):
                    return None
                scale = smallest_stretch(motion.forward, dimension)
                return scale.number if scale.is_constant else None

    def unscaled(self, motion: Motion, scale: float, dimension: int) -> Motion:
        """What is left to do for what has already been scaled: nothing but rounding keeps entries from -1, 0 or 1."""
        match motion:
            case Fixed():
                key = motion.forward[:9], motion.inverse[:9], scale, dimension
                if key not in self._unscaled:
                    self._unscaled[key] = _without_scale(*key)
                forward, inverse = self._unscaled[key]
                third = scale if dimension == 3 else 1.0
                shift = [_tidy(v * s) for v, s in zip(motion.inverse[9:], (scale, scale, third), strict=True)]
                return self._as_fixed((*forward, *motion.forward[9:]), (*inverse, *shift))
            case Live():
                shrink, grow = self._uniform(1.0 / scale, dimension), self._uniform(scale, dimension)
                return self._as_live(motion.forward.after(shrink).tidied(), grow.after(motion.inverse).tidied())

    def _as_fixed(self, forward: Numbers, inverse: Numbers) -> Fixed:
        key = forward, inverse
        return self._fixed.get(key) or self._fixed.setdefault(key, Fixed(forward, inverse))

    def _as_live(self, forward: Matrix, inverse: Matrix) -> Live:
        key = forward.entries, inverse.entries
        return self._live.get(key) or self._live.setdefault(key, Live(forward, inverse))

    def _uniform(self, scale: float, dimension: int) -> Matrix:
        return scaling(self._values, scale, scale, scale if dimension == 3 else 1.0)

    def _matrix(self, numbers: Numbers) -> Matrix:
        x, y, z = map(self._constant, numbers[9:])
        return Matrix(self._linear(numbers[:9]), (x, y, z))

    def _linear(self, numbers: Numbers) -> Linear:
        if numbers not in self._linears:
            a, b, c, d, e, f, g, h, i = map(self._constant, numbers)
            self._linears[numbers] = ((a, b, c), (d, e, f), (g, h, i))
        return self._linears[numbers]

    def _constant(self, number: float) -> Expr:
        return self._values.constant(number + 0.0)  # -0.0 is 0.0


def _without_scale(forward: Numbers, inverse: Numbers, scale: float, dimension: int) -> tuple[Numbers, Numbers]:
    """The linear parts of what is left to do."""
    third = scale if dimension == 3 else 1.0
    left = [_tidy(v / (third if i % 3 == 2 else scale)) for i, v in enumerate(forward)]
    return tuple(left), tuple([_tidy(v * (third if i // 3 == 2 else scale)) for i, v in enumerate(inverse)])


def backward_axes(motion: Fixed, dimension: int) -> list[int]:
    """The axes of the space moved whose coordinate falls with the first of the scene's that it depends on."""
    a = motion.inverse
    return [i for i in range(dimension) if (a[3 * i] or a[3 * i + 1] or a[3 * i + 2]) < 0.0]


def turned_round(motion: Fixed, axes: Collection[int]) -> Fixed:
    """The motion of what was first mirrored across these axes."""
    if not axes:
        return motion
    signs = [-1.0 if i in axes else 1.0 for i in range(3)]
    forward = [v * signs[i % 3] for i, v in enumerate(motion.forward[:9])]
    inverse = [v * signs[i // 3] for i, v in enumerate(motion.inverse[:9])]
    shift = [v * sign for v, sign in zip(motion.inverse[9:], signs, strict=True)]
    return Fixed((*forward, *motion.forward[9:]), (*inverse, *shift))


def _tidy(entry: float) -> float:
    nearest = float(round(entry)) if abs(entry) <= 1.5 else entry
    return nearest if abs(entry - nearest) < 1e-14 else entry
