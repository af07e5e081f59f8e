"""The closed-form intervals of lines in standard solids, against the sign of the gauge along them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from standard_entries import Array, Subject, default_subject, names_where, subjects
from test_claims import checked

from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator

_WITH_RAYS = names_where(lambda d: d.claims.ray is not None)
_SEEDS = st.integers(0, 2**32 - 1)
_LINES, _SAMPLES = 160, 40


def test_the_solids_that_must_have_rays_have_them() -> None:
    wanted = """
        plane slab sphere ellipsoid box cylinder cone capped_cone round_cone capsule convex_polyhedron wedge pyramid
        octahedron tetrahedron dodecahedron icosahedron prism hex_prism triangular_prism elliptical_cone quadric
        hyperboloid paraboloid lens cut_sphere solid_angle tube elliptical_cylinder torus
    """
    assert set(wanted.split()) <= set(_WITH_RAYS)


def _lines(subject: Subject, generator: np.random.Generator) -> tuple[Array, Array]:
    """Lines that go through or near the solid: from inside and outside, along axes and across, slow and fast."""
    target = subject.points(generator, _LINES, 0.9)
    origin = subject.points(generator, _LINES, 2.0)
    origin[:, : _LINES // 4] = subject.points(generator, _LINES // 4, 0.5)
    d = target - origin
    for axis in range(3):
        d[axis, axis * 10 : axis * 10 + 20] = 0.0  # some of them in two axes
    d[:, 60:64] = [[1, 0, 0, 0], [0, 1, 0, -1], [0, 0, 1, 0]]
    origin[:, 64:70] = 0.0
    origin[[0, 2], 70:75] = 0.0
    d[:, np.linalg.norm(d, axis=0) == 0] = 1.0
    d /= np.linalg.norm(d, axis=0)
    return origin, d * 10.0 ** generator.uniform(-2, 2, _LINES)


def _intervals(
    subject: Subject, o: Array, d: Array, grow: float, dtype: type[np.floating]
) -> list[tuple[Array, Array]]:
    graph, ray = subject.graph, subject.definition.claims.ray
    assert ray is not None
    found = ray(graph.input("o"), graph.input("d"), graph.input("grow", Type.FLOAT), subject.arguments)
    ends = Evaluator([end for interval in found for end in interval], dtype)({"o": o, "d": d, "grow": grow})
    values = [np.broadcast_to(np.asarray(end, float), (o.shape[1],)) for end in ends]
    assert not any(np.isnan(v).any() for v in values)
    return list(zip(values[::2], values[1::2], strict=True))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", _WITH_RAYS)
@checked
@given(data=st.data(), seed=_SEEDS, growth=st.sampled_from([0.0, 0.0, 0.1, -0.1, 0.7]))
def test_ray(name: str, dtype: type[np.floating], data: st.DataObject, seed: int, growth: float) -> None:
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    grow = growth * subject.scale
    o, d = _lines(subject, generator)
    o, d = o.astype(dtype).astype(float), d.astype(dtype).astype(float)
    grow = float(dtype(grow))
    intervals = _intervals(subject, o, d, grow, dtype)
    for (_, end), (start, _) in pairwise(intervals):
        assert (end <= start * (1 + 1e-6) + 1e-6).all() or not np.isfinite(start).all(), "sorted and disjoint"
    speed = np.linalg.norm(d, axis=0)
    slack = (1e-7 if dtype is np.float64 else 2e-3) * subject.scale
    o, d, speed = (np.repeat(v, _SAMPLES, axis=-1) for v in (o, d, speed))
    t = generator.uniform(-6, 6, len(speed)) * subject.scale / speed
    p = o + t * d
    gauge = subject.value(p, subject.gauge) - grow
    claimed = np.zeros(len(t), bool)
    at_end = np.zeros(len(t), bool)
    for enter, leave in (np.repeat(interval, _SAMPLES, axis=-1) for interval in intervals):
        claimed |= (enter < leave) & (enter <= t) & (t <= leave)
        at_end |= (np.minimum(np.abs(t - enter), np.abs(t - leave)) * speed < slack) & (enter < leave)
    wrong = np.flatnonzero((claimed != (gauge <= 0)) & ~at_end & (np.abs(gauge) > _noise(subject, p, slack)))
    assert len(wrong) == 0, [(o[:, i], d[:, i], t[i], gauge[i]) for i in wrong[:3]]


def _noise(subject: Subject, points: Array, slack: float) -> Array:
    """How much the gauge changes within the slack: grazing lines are not decided by it."""
    ahead = [subject.value(points + slack * np.eye(3)[:, [axis]], subject.gauge) for axis in range(3)]
    here = subject.value(points, subject.gauge)
    return np.sum([np.abs(a - here) for a in ahead], axis=0)


@pytest.mark.parametrize("name", _WITH_RAYS)
def test_ray_from_afar_in_float32(name: str) -> None:
    """From a thousand times its size away, the entry is off by a few roundings of that distance, and no hit is lost."""
    subject = default_subject(name)
    generator = np.random.default_rng(3)
    far = 1000.0 * subject.scale
    d = generator.normal(size=(3, 2000))
    d = (d / np.linalg.norm(d, axis=0)).astype(np.float32).astype(float)
    o = (subject.points(generator, 2000, 0.8) - d * far).astype(np.float32).astype(float)
    exact = _intervals(subject, o, d, 0.0, np.float64)[0]
    found = _intervals(subject, o, d, 0.0, np.float32)[0]
    hit = (exact[1] - exact[0] > 0.05 * subject.scale) & (np.abs(exact[0]) < 2.0 * far)
    assert (found[0] < found[1])[hit].all()
    assert np.quantile(np.abs(found[0] - exact[0])[hit], 0.99) <= 16 * np.spacing(np.float32(far))
