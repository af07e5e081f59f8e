"""Law: outside its region a function is above the level; a ray outside the interval is outside the region."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.field.graph import Expr, FieldGraph, Op
from sdfc.field.interval import IntervalEvaluator
from sdfc.field.numeric import Evaluator
from sdfc.reference.region import Region, region_of
from sdfc.reference.search import Rays

Field = Callable[[Expr], Expr]


def ball(p: Expr, centre: tuple[float, ...] = (0.3, -0.2, 0.1), radius: float = 0.4) -> Expr:
    return p.graph.length(p - p.graph.constant(*centre)) - radius


def turned_box(p: Expr) -> Expr:
    graph, s = p.graph, 0.5**0.5
    q = graph.vector(s * p[0] - s * p[2], p[1], s * p[0] + s * p[2])
    outside = graph.abs(q) - graph.constant(0.6, 0.2, 0.1)
    return graph.max(outside[0], graph.max(outside[1], outside[2]))


def twisted(p: Expr) -> Expr:
    graph = p.graph
    c, s = graph.call(Op.COS, 2.0 * p[1]), graph.call(Op.SIN, 2.0 * p[1])
    q = graph.vector(c * p[0] - s * p[2], p[1], s * p[0] + c * p[2])
    outside = graph.abs(q) - graph.constant(0.5, 0.7, 0.2)
    return graph.max(outside[0], graph.max(outside[1], outside[2]))


def jumping(p: Expr) -> Expr:
    """Its inside is told by comparisons, as a polygon's is: they change far away from it, too."""
    graph = p.graph
    across = graph.length(p.swizzle("xz")) - 0.3
    away = graph.max(graph.abs(across), graph.abs(p[1]) - 0.25)
    within = graph.add(Op.AND, graph.add(Op.AND, p[1] < 0.25, graph.constant(-0.25) < p[1]), across < 0.0)
    return graph.select(within, -1.0, 1.0) * graph.abs(away)


def rays(end: float = 6.0, count: int = 300, seed: int = 1) -> tuple[Rays, np.ndarray]:
    random = np.random.default_rng(seed)
    o = random.normal(size=(3, count))
    o *= 3.0 / np.linalg.norm(o, axis=0)
    d = random.uniform(-1.0, 1.0, (3, count)) - o
    d[0, ::7] = 0.0
    d[1, ::11] = 0.0
    return Rays.of(o, d / np.linalg.norm(d, axis=0), {}, 1e-11, None), np.full(count, end)


def found(field: Field, level: float = 0.01, end: float = 6.0) -> tuple[Region | None, Expr]:
    root = field(FieldGraph().input("p"))
    return region_of(IntervalEvaluator(root), level, *rays(end)), root


# how much wider than its solid: a turned box's interval over a cell is that of a wider one
@pytest.mark.parametrize(
    ("field", "end", "slack"),
    [
        (ball, 6.0, 1.4),
        (ball, 1e9, 1.4),
        (jumping, 6.0, 1.4),
        (jumping, 1e9, 1.4),
        (turned_box, 6.0, 1.7),
        (turned_box, 1e9, 1.7),
        (twisted, 6.0, 4.0),
    ],
)
def test_outside_the_region_the_function_is_above_the_level(field: Field, end: float, slack: float) -> None:
    region, root = found(field, end=end)
    assert region is not None and region.clearance > 0.0
    random = np.random.default_rng(2)
    points = np.concatenate(
        [random.uniform(-1.5, 1.5, (3, 40_000)), random.normal(size=(3, 5000)) * 10.0 ** random.uniform(0, 2, 5000)], 1
    )
    inside = ((points >= region.lo[:, None]) & (points <= region.hi[:, None])).all(axis=0)
    (values,) = Evaluator([root])({"p": points})
    assert (values[~inside] >= 0.01 + region.clearance - 1e-9).all()
    # and it is not much larger than it must be
    low = points[:, values <= 0.01]
    size = low.max(axis=1) - low.min(axis=1)
    assert ((region.hi - region.lo) < slack * size + 0.05).all()


@given(st.integers(0, 2**31))
@settings(max_examples=50)
def test_a_ray_outside_its_interval_is_outside_the_region(seed: int) -> None:
    random = np.random.default_rng(seed)
    region = Region(np.array([-0.3, -0.2, 0.1]), np.array([0.4, 0.5, 0.2]), 0.1)
    some, _ = rays(count=60, seed=seed)
    o = some.o.copy()
    o[0, ::14] = random.choice([-0.3, 0.4, 0.0], o[0, ::14].size)  # along a face, or within
    some = Rays.of(o, some.d, {}, 1e-11, None)
    enter, leave = region.interval(some)
    t = random.uniform(-1.0, 7.0, (400, 60))
    points = some.o[:, None] + t * some.d[:, None]
    inside = ((points > region.lo[:, None, None]) & (points < region.hi[:, None, None])).all(axis=0)
    outside = (t < enter - 1e-12) | (t > leave + 1e-12)
    assert not (inside & outside).any()
    assert (enter <= leave).any() or not inside.any()


def test_what_has_no_end_has_no_region() -> None:
    assert found(lambda p: p[1] + 0.2)[0] is None
    assert found(lambda p: p.graph.length(p.swizzle("xz")) - 0.2)[0] is None


def test_what_is_nowhere_is_missed_by_all() -> None:
    region, _ = found(lambda p: 1.0 + p.graph.length(p))
    assert region is not None and region.clearance >= 0.98
    enter, leave = region.interval(rays()[0])
    assert (enter > leave).all()


def test_the_zero_of_a_sign_is_not_cut_away() -> None:
    """sign(y)^2 is 1 but on the plane y = 0, where a ray may run."""

    def plane(p: Expr) -> Expr:
        sign = p.graph.call(Op.SIGN, p[1])
        return 2.0 * (sign * sign) - 1.0

    assert found(plane)[0] is None


def test_far_away_parts_are_found_too() -> None:
    """The region must hold what rays can reach, not what is around their origins."""
    assert found(lambda p: p.graph.min(ball(p), ball(p, (40.0, 0.0, 0.0))), end=100.0)[0] is None
    assert found(lambda p: p.graph.min(ball(p), ball(p, (4e3, 0.0, 0.0))), end=6.0)[0] is not None
