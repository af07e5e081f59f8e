"""Steps by what is known of the piece of the ray ahead (ALGORITHMS B1, B3), in float64: `piece` of marching.glsl."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SHORT = 4.0  # tolerances: what a piece is long in which a root is found; none is shorter


class Piece(NamedTuple):
    """What one look says, (n,) each."""

    clear: Array  # how far is empty, at the least
    there: Mask
    length: Array  # of the piece to look at next


def look(
    length: Array, value: Array, span: tuple[Array, Array, Array, Array], lipschitz: float, sunk: Array, eps: Array
) -> Piece:
    """At a field with this value, and this span over the piece of the ray that is `length` long.

    `span`: least and greatest value, least and greatest slope (sdfc/field/span). The solid is looked for a length
    `sunk` deeper. The constant may be infinite: then nothing is known but the span.

    It is there where no more than eps is clear of so short a piece: the slope near by counts, not the steepest.
    """
    low, _, fall, rise = span
    depth = sunk * np.maximum(np.maximum(-rise, fall), 0.0)  # it falls, or has risen, by this in the length `sunk`
    above = value + depth
    empty = (above > 0.0) & ((low + depth > 0.0) | (fall >= 0.0))
    part = np.minimum(length, np.maximum(above, 0.0) / np.maximum(-fall, 1e-30))
    clear = np.maximum(np.where(empty, length, part), above / max(lipschitz, 1e-9))
    root = np.minimum(length, np.where(rise < 0.0, np.maximum(above, 0.0) / np.maximum(-rise, 1e-30), length))
    there = (above <= 0.0) | ((clear <= eps) & (root <= SHORT * eps))
    shorter = np.where(rise < 0.0, root - clear, np.maximum(2.0 * clear, 0.25 * length))
    return Piece(clear, there, np.maximum(np.where(empty, 2.0 * length, shorter), SHORT * eps))
