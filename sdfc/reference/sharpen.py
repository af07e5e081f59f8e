"""Ends of ray intervals to float64's last digits, where a closed form's own iterations stop at float32's."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

HALVINGS = 60  # of a bracket: more than float64 has digits


def sharpened(enter: Array, leave: Array, gauge: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The intervals [enter, leave], (k, n) each, with the ends where `gauge` is 0; it is negative inside.

    `gauge(t)`: its value on each ray at t, (k, n) of both. An end is sought from the interval's middle to a little
    beyond the end; where the gauge does not change its sign between them, as on a line that only touches, it stays.
    """
    some = enter < leave
    with np.errstate(invalid="ignore"):
        middle = np.where(some, (enter + leave) / 2.0, 0.0)
        half = np.where(some, (leave - enter) / 2.0, 0.0)
    first, second = (_root(gauge, middle, middle + outward * half) for outward in (-1.25, 1.25))
    return np.where(np.isnan(first), enter, first), np.where(np.isnan(second), leave, second)


def _root(gauge: Callable[[Array], Array], inside: Array, outside: Array) -> Array:
    """Where the gauge is 0, by bisection between a t where it is negative and one where it is positive; else NaN."""
    bracketed = (gauge(inside) < 0.0) & (gauge(outside) > 0.0)
    for _ in range(HALVINGS):
        between = (inside + outside) / 2.0
        within = gauge(between) < 0.0
        inside, outside = np.where(within, between, inside), np.where(within, outside, between)
    return np.where(bracketed, (inside + outside) / 2.0, np.nan)
