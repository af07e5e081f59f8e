"""Affine maps on their way to the leaves: plain numbers as long as they can be, for scenes of thousands of parts."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TypeAlias

from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.graph import Affine
from sdfc.shape.matrix import Matrix, scaling
from sdfc.shape.stretch import is_similarity, scale_of, smallest_stretch

Numbers: TypeAlias = tuple[float, ...]  # twelve: the linear part row by row, then the offset


@dataclass(frozen=True, slots=True)
class Fixed:
    """A constant map and its inverse."""

    forward: Numbers
    inverse: Numbers


@dataclass(frozen=True, slots=True)
class Live:
    """A map that a param changes, and its inverse."""

    forward: Matrix
    inverse: Matrix


Motion: TypeAlias = Fixed | Live
_IDENTITY: Numbers = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
NOWHERE = Fixed(_IDENTITY, _IDENTITY)


class Motions:
    """Composes motions; makes matrices of one field graph."""

    def __init__(self, values: FieldGraph) -> None:
        self._values = values
        self._constants: dict[float, Expr] = {}

    def after(self, outer: Motion, inner: Affine) -> Motion:
        """`inner`'s map, then `outer`."""
        match outer:
            case Fixed():
                there, back = _numbers(inner.forward), _numbers(inner.inverse)
                if there is not None and back is not None:
                    return Fixed(_composed(outer.forward, there), _composed(back, outer.inverse))
            case Live():
                pass
        forward, inverse = self.matrices(outer)
        return Live(forward.after(inner.forward), inner.inverse.after(inverse))

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
                rows = [motion.forward[3 * i : 3 * i + dimension] for i in range(dimension)]
                return scale_of(rows)
            case Live():
                if not is_similarity(motion.forward, dimension):
                    return None
                scale = smallest_stretch(motion.forward, dimension)
                return scale.number if scale.is_constant else None

    def unscaled(self, motion: Motion, scale: float, dimension: int) -> Motion:
        """What is left to do for what has already been scaled: nothing but rounding keeps entries from -1, 0 or 1."""
        match motion:
            case Fixed():
                third = scale if dimension == 3 else 1.0
                forward = tuple([_tidy(v / (third if i % 3 == 2 else scale)) for i, v in enumerate(motion.forward[:9])])
                inverse = tuple([v * (third if i // 3 == 2 else scale) for i, v in enumerate(motion.inverse[:9])])
                shift = [v * s for v, s in zip(motion.inverse[9:], (scale, scale, third), strict=True)]
                return Fixed((*forward, *motion.forward[9:]), (*map(_tidy, inverse), *shift))
            case Live():
                shrink, grow = self._uniform(1.0 / scale, dimension), self._uniform(scale, dimension)
                return Live(motion.forward.after(shrink).tidied(), grow.after(motion.inverse).tidied())

    def _uniform(self, scale: float, dimension: int) -> Matrix:
        return scaling(self._values, scale, scale, scale if dimension == 3 else 1.0)

    def _matrix(self, numbers: Numbers) -> Matrix:
        e = [self._constants.get(n) or self._constant(n) for n in numbers]
        return Matrix(((e[0], e[1], e[2]), (e[3], e[4], e[5]), (e[6], e[7], e[8])), (e[9], e[10], e[11]))

    def _constant(self, number: float) -> Expr:
        made = self._constants[number] = self._values.constant(number + 0.0)  # -0.0 is 0.0
        return made


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


def _numbers(given: Matrix) -> Numbers | None:
    """The entries of a constant map."""
    first, second, third = given.linear
    entries = (*first, *second, *third, *given.offset)
    for entry in entries:
        if not entry.is_constant:
            return None
    return tuple([entry.number for entry in entries])


def _tidy(entry: float) -> float:
    nearest = float(round(entry)) if abs(entry) <= 1.5 else entry
    return nearest if abs(entry - nearest) < 1e-14 else entry


def _composed(a: Numbers, b: Numbers) -> Numbers:
    """Of a after b."""
    result: list[float] = []
    for i in (0, 3, 6):
        x, y, z = a[i], a[i + 1], a[i + 2]
        result += [x * b[j] + y * b[j + 3] + z * b[j + 6] for j in (0, 1, 2)]
    for i, shift in zip((0, 3, 6), a[9:], strict=True):
        result.append(a[i] * b[9] + a[i + 1] * b[10] + a[i + 2] * b[11] + shift)
    return tuple(result)
