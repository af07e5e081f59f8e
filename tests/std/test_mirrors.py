"""The mirror planes that are read off formulas: fields are the same on both sides, and rays are too."""

from __future__ import annotations

import numpy as np
import pytest
from standard_entries import Subject, default_subject, names_where

from sdfc.facts.parity import even_axes
from sdfc.field.numeric import Evaluator

_PRIMITIVES = names_where(lambda d: d.is_primitive)
_WITH_RAYS = names_where(lambda d: d.claims.ray is not None)


def _axes(subject: Subject) -> list[int]:
    arguments = [subject.arguments[p.name] for p in subject.definition.values]
    return [i for i, even in enumerate(even_axes(subject.definition, arguments, subject.graph)) if even]


def _flipped(points: np.ndarray, axis: int) -> np.ndarray:
    signs = np.ones((len(points), 1))
    signs[axis] = -1.0
    return points * signs


def test_those_of_the_usual_solids_are_found() -> None:
    wanted = {"box": [0, 1, 2], "cylinder": [0, 1, 2], "torus": [0, 1, 2], "cone": [0, 2], "wedge": [2], "plane": []}
    assert {name: _axes(default_subject(name)) for name in wanted} == wanted
    assert {"polygon", "prism", "slab"} <= {n for n in _PRIMITIVES if not _axes(default_subject(n))}


@pytest.mark.parametrize("name", _PRIMITIVES)
@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_values_are_the_same_to_the_last_bit(name: str, precision: type[np.floating]) -> None:
    subject = default_subject(name)
    points = subject.points(np.random.default_rng(8), 2000)
    value = Evaluator([subject.formula], precision)
    for axis in _axes(subject):
        here, there = (value({"p": p})[0] for p in (points, _flipped(points, axis)))
        assert (here == there).all()


@pytest.mark.parametrize("name", _WITH_RAYS)
def test_rays_are_in_the_solid_as_long(name: str) -> None:
    subject = default_subject(name)
    graph, ray = subject.graph, subject.definition.claims.ray
    assert ray is not None
    ends = [e for pair in ray(graph.input("o"), graph.input("d"), graph.constant(0.0), subject.arguments) for e in pair]
    generator = np.random.default_rng(9)
    o = 3.0 * subject.points(generator, 1000)
    d = subject.points(generator, 1000) - o
    for axis in _axes(subject):
        here = np.array(Evaluator(ends)({"o": o, "d": d}))
        there = np.array(Evaluator(ends)({"o": _flipped(o, axis), "d": _flipped(d, axis)}))
        hit = here[0::2] < here[1::2]
        assert (hit == (there[0::2] < there[1::2])).all() and hit.any()
        assert np.allclose(here[0::2][hit], there[0::2][hit], rtol=1e-9, atol=1e-9)
        assert np.allclose(here[1::2][hit], there[1::2][hit], rtol=1e-9, atol=1e-9)
