"""How hard fields bend down: second differences keep to the bounds, kinks and all."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from field_trees import PARAM_VALUES, Recipe, trees
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sdfc.field.bend import BendEvaluator, _Cells, bend_bounds
from sdfc.field.core import is_positive, signed_core
from sdfc.field.graph import LEAVES, Expr, FieldGraph, Op, Type, inputs_of, params_of, substitute
from sdfc.field.interval_bends import BENDS
from sdfc.field.interval_rules import Interval
from sdfc.field.memory import MEMORY
from sdfc.field.numeric import Evaluator

Array = NDArray[np.float64]
POINTS = 33


def test_every_operation_has_a_rule() -> None:
    assert set(BENDS) | LEAVES == set(Op)


def values_on(root: Expr, o: Array, d: Array, t: Array) -> Array:
    """(points, n) of the root at o + t d."""
    evaluate = Evaluator([root])
    params = {name: PARAM_VALUES[name] for name in params_of([root])}
    return np.stack([np.broadcast_to(evaluate({"p": o + x * d}, params)[0], (o.shape[1],)) for x in t])


@settings(max_examples=150, suppress_health_check=list(HealthCheck))
@given(tree=trees(Type.FLOAT), seed=st.integers(0, 2**31))
def test_second_differences_are_within_the_bounds(tree: Recipe, seed: int) -> None:
    """Along any line of a box, for any expression: (f(t - h) - 2 f(t) + f(t + h)) / h^2, however wide h is."""
    graph = FieldGraph()
    p = graph.input("p")
    parts = {Type.FLOAT: p[1], Type.VEC2: p.swizzle("zx"), Type.VEC3: p.swizzle("yzx"), Type.VEC4: p.swizzle("xyzy")}
    whole = tree.build(graph)
    root = substitute(whole, {i: parts[i.type] for i in inputs_of(whole) if i is not p})
    if not inputs_of(root):
        return
    random = np.random.default_rng(seed)
    count = 40
    o, d = random.uniform(-2.0, 2.0, (3, count)), random.normal(size=(3, count))
    d /= np.linalg.norm(d, axis=0)
    reach = 10.0 ** random.uniform(-2.0, 0.0, count)
    end = o + reach * d
    known = {n: np.asarray(PARAM_VALUES[n], float) for n in params_of([root])}
    params = {n: Interval(*[v.reshape(-1) if v.size == 1 else v.reshape(-1, 1)] * 2) for n, v in known.items()}
    box = Interval(np.minimum(o, end), np.maximum(o, end))
    _, bend = BendEvaluator(root, {})(box, Interval(d, d), params)
    t = np.linspace(0.0, 1.0, POINTS)
    values = np.stack([values_on(root, o, d * reach, np.array([x]))[0] for x in t])
    for width in (1, 4, 16):
        second = values[2 * width :] - 2.0 * values[width:-width] + values[: -2 * width]
        square = (reach * width / (POINTS - 1)) ** 2
        slack = 1e-9 * (1.0 + np.abs(values).max(axis=0))
        with np.errstate(invalid="ignore"):
            good = (second >= bend.lo * square - slack) & (second <= bend.hi * square + slack)
        assert (good | ~np.isfinite(second)).all()


def twisted(graph: FieldGraph, p: Expr, rate: float) -> Expr:
    c, s = graph.call(Op.COS, rate * p[1]), graph.call(Op.SIN, rate * p[1])
    return graph.vector(c * p[0] - s * p[2], p[1], s * p[0] + c * p[2])


def fields() -> dict[str, Expr]:
    graph = FieldGraph()
    p = graph.input("p")
    wave = graph.call(Op.SIN, 7.0 * p)
    q = graph.abs(twisted(graph, p, 1.5)) - graph.constant(0.3, 0.8, 0.3)
    edges = graph.length(graph.max(q, 0.0)) - 0.05
    return {
        "twisted box": edges,
        "rough ball": graph.length(p) - 0.7 + 0.05 * wave[0] * wave[1] * wave[2],
        "lattice": graph.abs(graph.dot(graph.call(Op.SIN, 5.0 * p), graph.call(Op.COS, 5.0 * p.swizzle("yzx")))) - 0.2,
        "hill": p[1] - 0.3 * graph.call(Op.EXP, -2.0 * graph.dot(p, p)),
        "bowl": graph.call(Op.SQRT, graph.dot(p, p) + 0.1) - 0.6,
    }


@pytest.mark.parametrize("name", fields())
def test_a_field_is_above_its_parabola(name: str) -> None:
    """What steps go by: f(x) >= f + f' x - K x x / 2 from any point outside the solid, up to the first way in."""
    root = fields()[name]
    lo, hi = [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]
    (bend,) = bend_bounds(root, lo, hi, [{}], {})
    assert math.isfinite(bend)
    random = np.random.default_rng(3)
    o, d = random.uniform(-1.0, 1.0, (3, 4000)), random.normal(size=(3, 4000))
    d /= np.linalg.norm(d, axis=0)
    t = np.linspace(0.0, 1.5, 301)
    values = values_on(root, o, d, t)
    inside_box = np.stack([(np.abs(o + x * d) <= 1.0).all(axis=0) for x in t])
    clear = np.minimum.accumulate((values > 0.0) & inside_box, axis=0)
    slope = (values_on(root, o, d, np.array([1e-6]))[0] - values[0]) / 1e-6  # to the right: at a kink the steeper side
    parabola = values[0] + slope * t[:, None] - 0.5 * bend * t[:, None] ** 2
    assert clear.sum() > 10_000
    assert (values >= parabola - 1e-5)[clear].all()
    assert bend < 250.0, "the bound is of no use"


def test_a_downward_kink_has_no_bound() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    assert math.isinf(bend_bounds(graph.min(p[0], p[1]) + 1.0, [-1.0] * 3, [1.0] * 3, [{}], {})[0])
    # but inside the solid nobody asks
    assert bend_bounds(graph.min(p[0], p[1]) - 5.0, [-1.0] * 3, [1.0] * 3, [{}], {}) == [0.0]


def test_what_is_convex_by_claim_bends_down_by_what_its_point_does() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    q = twisted(graph, p, 1.0)
    shape = graph.min(graph.max(q[0], q[1]), 0.0) + graph.length(graph.max(q, 0.0))
    unknown = bend_bounds(shape, [-1.0] * 3, [1.0] * 3, [{}], {})
    known = bend_bounds(shape, [-1.0] * 3, [1.0] * 3, [{}], {shape.id: (q, 1.0)})
    assert math.isinf(unknown[0]) and 1.0 < known[0] < 20.0


def test_pieces_of_a_range_are_bounded_each() -> None:
    graph = FieldGraph()
    p, rate = graph.input("p"), graph.param("rate")
    root = graph.call(Op.SIN, rate * p[0]) + 2.0
    bounds = bend_bounds(root, [-1.0] * 3, [1.0] * 3, [{"rate": ((0.0,), (1.0,))}, {"rate": ((3.0,), (4.0,))}], {})
    assert 0.8 < bounds[0] < 3.0 and 15.9 < bounds[1] < 40.0


def test_the_core_has_the_sign() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    core = p[0] - 0.3 * p[1]
    stretch = 1.0 + graph.length(p) + graph.sqrt(graph.abs(core))
    assert signed_core(2.0 * core / stretch) is core
    assert signed_core(core * graph.call(Op.EXP, p[1])) is core
    assert signed_core(core - 1.0).op is Op.SUB
    assert signed_core(core * p[1]).op is Op.MUL and not is_positive(p[1])


@pytest.mark.parametrize(
    "solid",
    [
        "difference(blend: 0.2) { box() cone().scale([1, 2, 1]) }",
        "difference(chamfer: 0.1) { box() solid_angle().shear(xy: 0.2) }",
        "difference(blend: 0.2) { box() lens().shear(xy: 0.2) }",
        "(~solid_angle().shear(xy: 0.2)).round(0.1) & sphere(radius: 2)",
    ],
)
def test_a_convex_part_that_is_stretched_and_taken_away_smoothly(solid: str) -> None:
    from sdfc.diagnostics import Source
    from sdfc.pipeline import compile_scene, load

    assert "march" in compile_scene(load(Source("test.sdf", f"scene {{ {solid} }}"))).glsl("depth")


def test_what_is_infinite_at_a_hub_is_given_up_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = FieldGraph()
    p = graph.input("p")
    ring = graph.length(graph.vector(graph.length(p.swizzle("xz")) - 0.7, p[1])) - 0.1
    looks: list[int] = []
    evaluate = BendEvaluator.__call__

    def counted(self: BendEvaluator, *given: Any) -> tuple[Interval, Interval]:
        looks.append(given[0].lo.shape[1])
        return evaluate(self, *given)

    monkeypatch.setattr(BendEvaluator, "__call__", counted)
    MEMORY.forget()
    assert bend_bounds(ring, [-1.0, -0.2, -1.0], [1.0, 0.2, 1.0], [{}, {}], {}) == [math.inf, math.inf]
    assert looks == [2, 16]


@settings(max_examples=100, suppress_health_check=list(HealthCheck))
@given(tree=trees(Type.FLOAT), size=st.floats(0.1, 3.0))
def test_what_is_given_up_has_no_bound(tree: Recipe, size: float) -> None:
    """Cutting boxes to the end finds none either."""
    graph = FieldGraph()
    p = graph.input("p")
    parts = {Type.FLOAT: p[1], Type.VEC2: p.swizzle("zx"), Type.VEC3: p, Type.VEC4: p.swizzle("xyzy")}
    whole = tree.build(graph)
    root = substitute(whole, {i: parts[i.type] for i in inputs_of(whole)})
    if not inputs_of(root):
        return
    piece = {n: (np.ravel(PARAM_VALUES[n]).tolist(),) * 2 for n in params_of([root])}
    given = root, [-size] * 3, [size] * 3, [piece], {}
    (bend,) = bend_bounds(*given, boxes=128)
    with pytest.MonkeyPatch.context() as patch:
        MEMORY.forget()
        patch.setattr(_Cells, "is_vain", lambda self: False)
        assert bend_bounds(*given, boxes=128) == [bend]
