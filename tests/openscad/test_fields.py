"""What the fields of fields.py claim: no value is more than the distance, bounds hold, and what is convex is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.openscad.fields import field
from sdfc.openscad.outline import regular
from sdfc.shape.definition import Argument, ChildFacts

GRAPH = FieldGraph()


def disc(p: Expr) -> Expr:
    """Off the axis: its far side is 3 from it."""
    return GRAPH.length(p - GRAPH.constant(1.0, 0.0)) - 2.0


def number(value: float) -> Expr:
    return GRAPH.constant(value)


def ball(sides: int) -> dict[str, Argument]:
    """Three rings: two slopes, by hand."""
    apothem = math.cos(math.pi / sides)
    low, high = (2.0, 0.0), (1.0, 1.5)
    slope = np.array([high[1] - low[1], apothem * (low[0] - high[0])])
    slope /= np.linalg.norm(slope)
    return {
        "sides": number(sides),
        "normals": (GRAPH.constant(*slope),),
        "offsets": (number(float(slope @ (apothem * low[0], low[1]))),),
        "radius": number(2.0),
        "height": number(1.5),
    }


def cone(sides: int, bottom: float, top: float) -> dict[str, Argument]:
    sizes = {"sides": float(sides), "bottom": bottom, "top": top, "height": 3.0}
    return {name: number(value) for name, value in sizes.items()}


def tower(top: float, rate: float) -> dict[str, Argument]:
    return {name: number(v) for name, v in {"height": 4.0, "top": top, "rate": rate, "reach": 3.0}.items()}


CASES = {
    "ball of 5": ("faceted_ball", ball(5)),
    "ball of 30": ("faceted_ball", ball(30)),
    "prism of 7": ("faceted_cone", cone(7, 2.0, 2.0)),
    "cone of 13": ("faceted_cone", cone(13, 2.0, 0.0)),
    "cone upside down": ("faceted_cone", cone(4, 0.5, 2.0)),
    "to a point": ("tapered_extrusion", tower(0.0, 0.0)),
    "turned to a point": ("tapered_extrusion", tower(0.0, 1.5)),
    "growing": ("tapered_extrusion", tower(2.0, -0.7)),
}


def value(name: str, points: np.ndarray) -> np.ndarray:
    kind, arguments = CASES[name]
    definition = field(kind, GRAPH)
    assert definition is not None
    p = GRAPH.input("p", Type.VEC3)
    (values,) = Evaluator([definition.formula(p, arguments, {"shape": disc})])({"p": points.T})
    return values


def facts(name: str, level: float) -> tuple[np.ndarray, np.ndarray]:
    kind, arguments = CASES[name]
    definition = field(kind, GRAPH)
    assert definition is not None and definition.claims.bounds is not None
    around = ChildFacts(GRAPH.constant(-1.0, -2.0), GRAPH.constant(3.0, 2.0), number(1.0))
    lo, hi = definition.claims.bounds(arguments, {"shape": around}, number(level))
    return np.array(lo.numbers), np.array(hi.numbers)


def somewhere(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-5.0, 5.0, size=(count, 3))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("step", [5.0, 0.3, 1e-3])
def test_no_value_changes_faster_than_the_distance(name: str, step: float) -> None:
    points = somewhere(20_000, 1)
    others = points + np.random.default_rng(2).normal(size=points.shape) * step
    rise = np.abs(value(name, points) - value(name, others)) / np.linalg.norm(points - others, axis=1)
    assert rise.max() < 1.0 + 1e-6


@pytest.mark.parametrize("name", CASES)
def test_bounds(name: str) -> None:
    points = somewhere(40_000, 3)
    for level in (0.0, 0.5):
        lo, hi = facts(name, level)
        held = points[value(name, points) <= level]
        assert len(held) > 100
        assert (held >= lo).all() and (held <= hi).all()


@pytest.mark.parametrize("name", [n for n, (kind, _) in CASES.items() if kind.startswith("faceted")])
def test_convex(name: str) -> None:
    a, b = somewhere(20_000, 4), somewhere(20_000, 5)
    assert (value(name, 0.5 * (a + b)) <= 0.5 * (value(name, a) + value(name, b)) + 1e-9).all()


def test_the_axis_and_the_tip_are_no_trouble() -> None:
    points = np.array([[0.0, 0.0, z] for z in (-3.0, -1.0, 0.0, 1.9, 2.0, 2.5)])
    for name in CASES:
        assert np.isfinite(value(name, points)).all()
    assert value("to a point", np.array([[0.0, 0.0, 2.5]])) == pytest.approx([0.5], abs=0.3)


def test_a_prism_is_the_polygon() -> None:
    corners = np.array([(0.999 * x, 0.999 * y, 0.0) for x, y in regular(7, 2.0)])
    assert (value("prism of 7", corners) < 0.0).all()
    assert (value("prism of 7", corners / 0.999 * 1.001) > 0.0).all()
    middles = 0.5 * (corners + np.roll(corners, 1, axis=0))
    assert (value("prism of 7", middles / 0.999 * 1.001) > 0.0).all()
