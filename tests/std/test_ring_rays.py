"""The closed form of a line's intervals with a ring, in float32, along the lines that are hard for it.

Law: what is claimed to be inside and outside is so, to a few roundings of the largest length there is.
"""

from __future__ import annotations

import numpy as np
import pytest
from standard_entries import Array

from sdfc.field.graph import FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.scene.library import Library

_COUNT, _SAMPLES = 20000, 60
_FEW = 8 * 2.0**-23
_RATIOS = [0.02, 0.3, 0.9, 0.9999]


def _intervals(o: Array, d: Array, major: float, minor: float) -> list[tuple[Array, Array]]:
    graph = FieldGraph()
    ring = Library(graph).definition("torus")
    assert ring is not None and ring.claims.ray is not None
    arguments = {name: graph.input(name, Type.FLOAT) for name in ("major", "minor")}
    pairs = ring.claims.ray(graph.input("o"), graph.input("d"), graph.constant(0.0), arguments)
    values = {"o": o, "d": d, "major": np.full(o.shape[1], major), "minor": np.full(o.shape[1], minor)}
    ends = Evaluator([end for pair in pairs for end in pair], np.float32)(values)
    assert not any(np.isnan(end).any() for end in ends)
    return [(a.astype(float), b.astype(float)) for a, b in zip(ends[::2], ends[1::2], strict=True)]


def _error(o: Array, d: Array, major: float, minor: float, generator: np.random.Generator) -> float:
    """How far inside or outside the ring a point is that is said to be the other."""
    o, d = o.astype(np.float32).astype(float), d.astype(np.float32).astype(float)
    major, minor = float(np.float32(major)), float(np.float32(minor))
    size, speed = major + minor, np.linalg.norm(d, axis=0)
    intervals = _intervals(o, d, major, minor)
    middle = -np.sum(o * d, axis=0) / speed**2
    t = middle + 1.2 * size / speed * generator.uniform(-1, 1, (_SAMPLES, o.shape[1]))
    near = [np.clip(end, t.min(axis=0), t.max(axis=0)) for interval in intervals for end in interval]
    t = np.concatenate([t, near])
    inside = np.zeros(t.shape, bool)
    for enter, leave in intervals:
        inside |= (enter < leave) & (enter <= t) & (t <= leave)
    x, y, z = o[:, None] + t * d[:, None]
    value = np.hypot(np.hypot(x, z) - major, y) - minor
    return float(np.where(inside, value, -value).max())


def _directions(generator: np.random.Generator) -> Array:
    d: Array = generator.normal(size=(3, _COUNT))
    d /= np.linalg.norm(d, axis=0)
    return d


@pytest.mark.parametrize("ratio", _RATIOS)
@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-4, 1e-5, 1e-6])
def test_a_ring_much_smaller_than_the_way_to_it(size: float, ratio: float) -> None:
    """Lines that begin up to two away: as in a scene in which there are much larger things."""
    generator = np.random.default_rng(5)
    d = _directions(generator)
    near = size * generator.uniform(-1, 1, (3, _COUNT)) * [[1.0], [ratio / (1.0 + ratio)], [1.0]]
    o = near - d * generator.uniform(-2, 2, _COUNT)
    assert _error(o, d, size / (1.0 + ratio), size / (1.0 + ratio) * ratio, generator) <= _FEW


@pytest.mark.parametrize("ratio", _RATIOS)
@pytest.mark.parametrize("touch", ["once", "three times"])
def test_lines_that_touch(touch: str, ratio: float) -> None:
    """Lines near one that touches the ring, anywhere; or, in its hole, along an asymptotic direction: three times."""
    generator = np.random.default_rng(6)
    major, minor = 1.0 / (1.0 + ratio), ratio / (1.0 + ratio)
    around = generator.uniform(0, 2 * np.pi, _COUNT)
    tube = generator.uniform(np.pi / 2, 3 * np.pi / 2, _COUNT)
    rho = major + minor * np.cos(tube)
    point = np.stack([rho * np.cos(around), minor * np.sin(tube), rho * np.sin(around)])
    normal = np.stack([np.cos(tube) * np.cos(around), np.sin(tube), np.cos(tube) * np.sin(around)])
    if touch == "once":
        d = _directions(generator)
        d -= normal * np.sum(normal * d, axis=0)
    else:
        across = np.stack([-np.sin(tube) * np.cos(around), np.cos(tube), -np.sin(tube) * np.sin(around)])
        along = np.stack([-np.sin(around), 0 * around, np.cos(around)])
        slope = np.sqrt(-np.cos(tube) / rho * minor)  # Euler's formula: the curvature is 0 there
        d = slope * across + along
    d /= np.linalg.norm(d, axis=0)
    d += _directions(generator) * 10 ** generator.uniform(-7, -1, _COUNT)
    d /= np.linalg.norm(d, axis=0)
    off = generator.choice([-1, 1], _COUNT) * 10 ** generator.uniform(-9, -2, _COUNT)
    o = point + normal * off - d * generator.uniform(-2, 2, _COUNT)
    assert _error(o, d, major, minor, generator) <= _FEW


@pytest.mark.parametrize("ratio", _RATIOS)
def test_lines_along_axes_and_planes(ratio: float) -> None:
    """Where the quartic is a quadratic of squares: q is 0, or next to it."""
    generator = np.random.default_rng(7)
    tilt = np.where(generator.random((3, _COUNT)) < 0.5, 0.0, 10 ** generator.uniform(-9, -2, (3, _COUNT)))
    d = np.eye(3)[generator.integers(0, 3, _COUNT)].T + tilt
    flat = generator.random(_COUNT) < 0.3
    d[:, flat] = _directions(generator)[:, flat] * [[1.0], [0.0], [1.0]]
    near = generator.uniform(-1, 1, (3, _COUNT)) * [[1.0], [ratio / (1.0 + ratio)], [1.0]]
    near *= generator.choice([0.0, 1e-4, 1.0], (3, _COUNT))
    o = near - d * generator.uniform(-2, 2, _COUNT)
    d *= 10 ** generator.uniform(-2, 2, _COUNT)
    assert _error(o, d, 1.0 / (1.0 + ratio), ratio / (1.0 + ratio), generator) <= _FEW
