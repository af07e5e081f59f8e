"""Law: part by part, alone or among many, a ray gets the answer that the whole distance gives it."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.field.graph import Expr, FieldGraph, Op
from sdfc.field.numeric import Evaluator
from sdfc.reference.certify import Certificate, Status, first_roots
from sdfc.reference.parts import Parts, parts_of
from sdfc.reference.search import Rays

Place = tuple[float, float, float]


def ball(p: Expr, centre: Place, radius: float) -> Expr:
    return p.graph.length(p - p.graph.constant(*centre)) - radius


def box(p: Expr, centre: Place, half: Place) -> Expr:
    graph = p.graph
    q = graph.abs(p - graph.constant(*centre)) - graph.constant(*half)
    return graph.length(graph.max(q, 0.0)) + graph.min(graph.max(q[0], graph.max(q[1], q[2])), 0.0)


def rays(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    o = random.normal(size=(3, count))
    o *= 3.0 / np.linalg.norm(o, axis=0)
    d = random.uniform(-0.8, 0.8, (3, count)) - o
    return o, d / np.linalg.norm(d, axis=0)


@st.composite
def unions(draw: st.DrawFn) -> Expr:
    """Balls and boxes, some cut: each of constant 1, so that a proof of the whole by its constant is allowed."""
    p = FieldGraph().input("p")
    place, size = st.tuples(*[st.floats(-0.8, 0.8)] * 3), st.floats(0.05, 0.5)
    result: Expr | None = None
    for _ in range(draw(st.integers(2, 7))):
        part = ball(p, draw(place), draw(size))
        if draw(st.booleans()):
            part = box(p, draw(place), (draw(size), draw(size), draw(size)))
        if draw(st.booleans()):
            part = p.graph.max(part, -ball(p, draw(place), draw(size)))
        result = part if result is None else p.graph.min(result, part)
    assert result is not None
    return result


def same(a: Certificate, b: Certificate) -> None:
    np.testing.assert_array_equal(a.status, b.status)
    sure = ~(a.contested | b.contested)
    assert (a.contested != b.contested).mean() < 0.01
    for name in ("t_lo", "t_hi", "t_early", "t_late"):
        np.testing.assert_allclose(getattr(a, name)[sure], getattr(b, name)[sure], atol=1e-9)


@settings(max_examples=40)
@given(unions(), st.integers(0, 2**31))
def test_the_parts_say_what_the_whole_says(distance: Expr, seed: int) -> None:
    """A Lipschitz constant is one of the whole, so with it the whole is searched."""
    o, d = rays(150, seed)
    ends = {"thin": 1e-6, "tolerance": 1e-4}
    same(first_roots(distance, o, d, 0.0, 6.0, **ends), first_roots(distance, o, d, 0.0, 6.0, lipschitz=1.0, **ends))


@settings(max_examples=10)
@given(unions(), st.integers(0, 2**31))
def test_a_ray_alone_gets_the_answer_that_it_gets_among_many(distance: Expr, seed: int) -> None:
    """Many rays have regions and segments one by one; few have many segments at once."""
    o, d = rays(6000, seed)
    together = first_roots(distance, o, d, 0.0, 6.0, thin=1e-6, tolerance=1e-4)
    some = np.arange(0, 6000, 600)
    for i in some:
        alone = first_roots(distance, o[:, i : i + 1], d[:, i : i + 1], 0.0, 6.0, thin=1e-6, tolerance=1e-4)
        one = Certificate(*(getattr(together, f.name)[i : i + 1] for f in fields(Certificate)))
        if alone.contested[0] == one.contested[0]:
            same(alone, one)
    misses = (together.status == Status.MISS) & ~together.contested
    assert (together.clearance[misses] >= 1e-4).all()


def test_a_clearance_is_a_lower_bound() -> None:
    p = FieldGraph().input("p")
    distance = p.graph.min(ball(p, (0.4, 0.0, 0.0), 0.3), box(p, (-0.4, 0.1, 0.0), (0.2, 0.2, 0.2)))
    o, d = rays(6000, 4)
    truth = first_roots(distance, o, d, 0.0, 6.0, thin=1e-6, tolerance=1e-4)
    miss = truth.status == Status.MISS
    least = np.full(miss.sum(), np.inf)
    for t in np.linspace(0.0, 6.0, 800):
        least = np.minimum(least, Evaluator([distance])({"p": o[:, miss] + t * d[:, miss]})[0])
    assert miss.sum() > 2000 and (truth.clearance[miss] <= least).all()


def test_parts_are_the_operands_of_nested_minima() -> None:
    p = FieldGraph().input("p")
    balls = [ball(p, (0.1 * i, 0.0, 0.0), 0.2) for i in range(6)]
    graph = p.graph
    nested = graph.min(graph.min(balls[0], balls[1]), graph.min(balls[2], graph.max(balls[3], balls[4])))
    assert parts_of(graph.min(nested, balls[0])) == [balls[0], balls[1], balls[2], graph.max(balls[3], balls[4])]
    chain = balls[0]
    for i in range(5000):
        chain = graph.min(chain, ball(p, (0.0, 1e-3 * i, 0.0), 0.1))
    assert len(parts_of(chain)) == 5001


def test_parts_prove_together_what_none_proves_alone() -> None:
    """Along the segment from -1 to 1 each of two boxes is below zero only on its own half."""
    p = FieldGraph().input("p")
    halves = [box(p, (0.5 * side, 0.0, 0.0), (0.7, 0.3, 0.3)) for side in (-1, 1)]
    o, d = np.array([[-3.0], [0.0], [0.0]]), np.array([[1.0], [0.0], [0.0]])
    index, owner = np.zeros(1, np.intp), np.zeros(1, np.intp)

    def below(distance: Expr, end: float) -> bool:
        parts = Parts(distance, Rays.of(o, d, {}, 1e-11, None))
        parts.survey(1e-3, np.zeros(1), np.full(1, 6.0), lambda share: None)
        return bool(parts.below(0.0, np.array([2.0]), np.array([end]), index, owner)[0])

    assert below(p.graph.min(*halves), 4.0)
    assert not below(p.graph.min(*halves), 4.3)
    assert not below(halves[0], 4.0)


@pytest.mark.parametrize("count", [1, 5])
def test_parts_that_jump_at_one_height_do_not_hide_what_is_behind(count: int) -> None:
    """As pieces on a board: comparisons tell their insides, and change at one t in all of them, far from the ray."""
    graph = FieldGraph()
    p = graph.input("p")
    distance = p[1] + 0.5
    for i in range(count):
        q = p - graph.constant(0.4 * i - 0.8, 0.0, -2.0)
        across = graph.length(q.swizzle("xz")) - 0.1
        away = graph.max(graph.abs(across), graph.abs(q[1]) - 0.25)
        within = graph.add(Op.AND, q[1] < 0.25, across < 0.0)
        distance = graph.min(distance, graph.select(within, -1.0, 1.0) * graph.abs(away))
    x = np.linspace(-1.0, 1.0, 40)
    o = np.stack([x, np.full(40, 2.0), np.full(40, 2.0)])
    d = np.repeat(np.array([[0.01], [-1.0], [0.02]]), 40, axis=1)
    truth = first_roots(distance, o, d, 0.0, 6.0, thin=3e-6, tolerance=1e-3)
    assert (truth.status == Status.HIT).all() and not truth.contested.any()
    np.testing.assert_allclose(truth.t_lo, 2.5, atol=1e-9)
