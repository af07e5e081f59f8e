"""Bounds along pieces of rays, as expressions: in float64 and on the GPU they hold what the field does there."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from field_trees import PARAM_VALUES, Recipe, trees
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sdfc.field.function import Function
from sdfc.field.graph import LEAVES, Expr, FieldGraph, Op, Type, inputs_of, params_of, substitute
from sdfc.field.interval import IntervalEvaluator
from sdfc.field.numeric import Evaluator
from sdfc.field.span import span
from sdfc.field.span_ranges import HUGE
from sdfc.field.span_rules import RULES

sys.path.append(str(Path(__file__).parent.parent / "std"))
from standard_entries import NAMES, Subject, default_subject, subjects

Array = NDArray[np.float64]
SAMPLES = 33


def test_every_operation_has_a_rule() -> None:
    assert set(RULES) | LEAVES == set(Op)


def spanned(root: Expr, size: int) -> Function:
    graph = root.graph
    p, d, s = graph.input("p", Type(size)), graph.input("d", Type(size)), graph.input("s", Type.FLOAT)
    formal = (("p", Type(size)), ("d", Type(size)), ("s", Type.FLOAT))
    return Function("spanned", formal, span(root, p, d, s).vector)


def pieces(random: np.random.Generator, points: Array, scale: float) -> tuple[Array, Array, Array]:
    """Pieces of rays from the points, of all lengths, some along an axis; numbers that float32 has."""
    size, count = points.shape
    d = random.normal(size=(size, count))
    d /= np.linalg.norm(d, axis=0)
    d[:, ::7] = np.eye(size)[random.integers(0, size, d[:, ::7].shape[1])].T
    s = scale * 10.0 ** random.uniform(-4.0, 0.0, count)
    rounded = [a.astype(np.float32).astype(np.float64) for a in (points, d, s)]
    return rounded[0], rounded[1], rounded[2]


def check(root: Expr, bounds: Array, p: Array, d: Array, s: Array, rounding: float) -> None:
    """Values, and chords from sample to sample and from the start, within the bounds. `bounds` is (4, n)."""
    params = {name: PARAM_VALUES[name] for name in params_of([root])}
    evaluate = Evaluator([root])
    tau = np.linspace(0.0, 1.0, SAMPLES)[:, None] * s
    values = np.stack([np.broadcast_to(evaluate({"p": p + x * d}, params)[0], s.shape) for x in tau])
    slack = rounding * (1.0 + np.abs(values).max(axis=0))
    lo, hi, least, most = bounds
    good = ~np.isfinite(values).all(axis=0)
    assert good.mean() < 0.5
    assert (good | ~np.isnan(bounds).any(axis=0)).all()
    assert (good | ((values >= lo - slack) & (values <= hi + slack))).all()
    for start, end in ((values[:1], values), (values[:-1], values[1:])):
        run = tau if start.shape[0] == 1 else np.diff(tau, axis=0)
        rise = end - start
        assert (good | (least <= -HUGE) | (rise >= least * run - slack)).all()
        assert (good | (most >= HUGE) | (rise <= most * run + slack)).all()


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=3, suppress_health_check=list(HealthCheck))
@given(data=st.data(), seed=st.integers(0, 2**31))
def test_every_standard_field(name: str, data: st.DataObject, seed: int) -> None:
    subject: Subject = data.draw(subjects(name)) if not name.endswith("_in_plane") else default_subject(name)
    random = np.random.default_rng(seed)
    size = subject.definition.dimension
    p, d, s = pieces(random, subject.points(random, 400), subject.scale)
    (bounds,) = Evaluator([spanned(subject.formula, size).result])({"p": p, "d": d, "s": s})
    check(subject.formula, np.broadcast_to(bounds, (4, s.size)), p, d, s, 1e-7 * max(1.0, subject.scale))


@settings(max_examples=200, suppress_health_check=list(HealthCheck))
@given(tree=trees(Type.FLOAT), seed=st.integers(0, 2**31))
def test_every_expression(tree: Recipe, seed: int) -> None:
    graph = FieldGraph()
    p = graph.input("p")
    parts = {Type.FLOAT: p[1], Type.VEC2: p.swizzle("zx"), Type.VEC3: p.swizzle("yzx"), Type.VEC4: p.swizzle("xyzy")}
    whole = tree.build(graph)
    root = substitute(whole, {i: parts[i.type] for i in inputs_of(whole) if i is not p})
    random = np.random.default_rng(seed)
    o, d, s = pieces(random, random.uniform(-2.0, 2.0, (3, 100)), 1.0)
    params = {name: PARAM_VALUES[name] for name in params_of([root])}
    (bounds,) = Evaluator([spanned(root, 3).result])({"p": o, "d": d, "s": s}, params)
    check(root, np.broadcast_to(bounds.reshape(4, -1), (4, s.size)), o, d, s, 1e-7)


def test_it_is_as_tight_as_intervals_of_numbers() -> None:
    """Of the whole standard table: tighter where something is affine or convex by its form, and looser hardly ever."""
    looser, tighter, total = 0, 0, 0
    for name in NAMES:
        subject = default_subject(name)
        random = np.random.default_rng(5)
        size = subject.definition.dimension
        p, d, s = pieces(random, subject.points(random, 200), subject.scale)
        (bounds,) = Evaluator([spanned(subject.formula, size).result])({"p": p, "d": d, "s": s})
        bounds = np.broadcast_to(bounds, (4, s.size))
        slab = IntervalEvaluator(subject.formula).along_ray(p, d, np.zeros(s.size), s)
        width, other = bounds[3] - bounds[2], np.minimum(slab.slope_hi - slab.slope_lo, 2.0 * HUGE)
        looser += int((width > 1.05 * other + 1e-4).sum())
        tighter += int((width < 0.95 * other - 1e-4).sum())
        total += s.size
    assert looser < 0.01 * total < 0.3 * total < tighter


@pytest.mark.gpu
@pytest.mark.parametrize("name", [n for n in NAMES if not n.endswith("_in_plane")])
def test_the_gpu_holds_what_float64_does(name: str, run_function: Callable[..., NDArray[np.float32]]) -> None:
    subject = default_subject(name)
    random = np.random.default_rng(len(name))
    p, d, s = pieces(random, subject.points(random, 1000), subject.scale)
    made = run_function(spanned(subject.formula, subject.definition.dimension), {"p": p, "d": d, "s": s})
    # the field's own rounding: some ulps of its coordinates, times how fast it changes
    check(subject.formula, made.astype(np.float64), p, d, s, 2e-5 * max(1.0, subject.scale))


def test_what_is_affine_or_a_distance_is_exact() -> None:
    graph = FieldGraph()
    p, d, s = graph.input("p"), graph.input("d"), graph.input("s", Type.FLOAT)
    plane = span(graph.dot(p, graph.constant(0.6, 0.8, 0.0)) - 1.0, p, d, s)
    ball = span(graph.length(p - graph.constant(1.0, 2.0, 3.0)) - 1.0, p, d, s)
    o, along, far = np.array([[0.3], [0.2], [0.1]]), np.array([[0.6], [0.0], [0.8]]), np.array([2.5])
    inputs = {"p": o, "d": along, "s": far}
    lo, hi = (float(a[0]) for a in Evaluator([*plane.slope])(inputs))
    assert lo == pytest.approx(0.36, abs=4e-6) and hi == pytest.approx(0.36, abs=4e-6)
    lo, hi = (float(a[0]) for a in Evaluator([*ball.slope])(inputs))
    to = o - np.array([[1.0], [2.0], [3.0]])
    ends = [float((x.T @ along).item() / np.linalg.norm(x)) for x in (to, to + far * along)]
    assert (lo, hi) == (pytest.approx(ends[0], abs=6e-6), pytest.approx(ends[1], abs=6e-6))
