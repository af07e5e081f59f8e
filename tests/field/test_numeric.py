"""float64 evaluation, and what the graph does to expressions as they are built."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from field_trees import PARAM_VALUES, PlainGraph, Recipe, node, number, points, trees
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.field import numeric
from sdfc.field.folding import fold
from sdfc.field.graph import COMPARISON, LEAVES, LOGIC, Expr, FieldGraph, Op, Type, topological
from sdfc.field.numeric import Evaluator
from sdfc.field.order import evaluation_order

ANY_TYPE = st.sampled_from([Type.BOOL, Type.FLOAT, Type.VEC2, Type.VEC3, Type.VEC4])


def evaluate(root: Expr, inputs: dict[str, np.ndarray]) -> np.ndarray:
    (value,) = Evaluator([root])(inputs, PARAM_VALUES)
    return value


def spheres(count: int, to_the_right: bool) -> Expr:
    graph = FieldGraph()
    p = graph.input("p")
    random = np.random.default_rng(1)
    distances = [graph.length(p - graph.constant(*random.normal(size=3))) - 0.25 for _ in range(count)]
    union = distances[0]
    for distance in distances[1:]:
        union = graph.min(distance, union) if to_the_right else graph.min(union, distance)
    return union


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_simplified_and_folded_expressions_keep_their_value(data: st.DataObject) -> None:
    recipe = data.draw(trees(data.draw(ANY_TYPE)))
    inputs = points(40)
    plain = recipe.build(PlainGraph())
    simple = recipe.build(FieldGraph())
    assert simple.type is plain.type
    expected = evaluate(plain, inputs)
    # rounding may differ by folding (fsum, hypot): where that decides a step or a comparison, neither value is wrong
    shaken = evaluate(plain, {name: values * (1.0 + 1e-13) for name, values in inputs.items()})
    settled = np.isclose(expected, shaken, rtol=1e-6, atol=1e-6)
    close = np.isclose(evaluate(simple, inputs), expected, rtol=1e-9, atol=1e-9)
    assert np.all(close | ~settled) or np.mean(close) > 0.95


@given(trees())
def test_a_node_is_one_of_its_kind(recipe: Recipe) -> None:
    graph = FieldGraph()
    assert recipe.build(graph) is recipe.build(graph)


@pytest.mark.parametrize(
    ("op", "args", "expected"),
    [
        (Op.DIV, (1.0, -0.0), -math.inf),
        (Op.DIV, (-1.0, 0.0), -math.inf),
        (Op.DIV, (0.0, 0.0), math.nan),
        (Op.FLOOR, (-math.inf,), -math.inf),
        (Op.LOG, (0.0,), -math.inf),
        (Op.LOG, (-1.0,), math.nan),
        (Op.SQRT, (-1.0,), math.nan),
        (Op.EXP, (1e4,), math.inf),
        (Op.POW, (-1e300, 3.0), -math.inf),
        (Op.POW, (0.0, -2.0), math.inf),
        (Op.POW, (-8.0, 0.5), math.nan),
        (Op.MOD, (1.0, 0.0), math.nan),
        (Op.MIN, (1.0, math.nan), math.nan),
        (Op.MAX, (math.nan, 1.0), math.nan),
        (Op.MIN, (math.inf, -math.inf), -math.inf),
        (Op.MAX, (-2.0, 3.0), 3.0),
        (Op.SIN, (math.inf,), math.nan),
        (Op.ROUND, (2.5,), 3.0),
        (Op.ROUND, (-2.5,), -2.0),
    ],
)
def test_folding_meets_the_edges_of_the_domain_as_numpy_does(op: Op, args: tuple[float, ...], expected: float) -> None:
    (folded,) = fold(op, [(a,) for a in args], 1, None)
    with np.errstate(all="ignore"):
        reference = numeric.FUNCTIONS[op](*(np.float64(a) for a in args))
    assert folded == pytest.approx(expected, nan_ok=True)
    assert float(reference) == pytest.approx(expected, nan_ok=True)


def test_folding_a_dot_product_of_infinities_is_no_error() -> None:
    assert math.isnan(fold(Op.DOT, [(math.inf, 1.0), (1.0, -math.inf)], 1, None)[0])
    assert fold(Op.DOT, [(math.inf, 1.0), (1.0, 1.0)], 1, None) == (math.inf,)


def test_every_operation_has_a_numeric_rule() -> None:
    own = {Op.VECTOR, Op.SWIZZLE, Op.LENGTH, Op.DOT}
    assert set(numeric.FUNCTIONS) | own | LEAVES == set(Op)


def test_shapes() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    t = graph.input("t", Type.FLOAT)
    beta = graph.param("beta", Type.VEC3)
    roots = [p, t, p * t, graph.length(p), t < 0.0, beta, graph.length(beta), graph.constant(2.0), beta[1]]
    roots.append(graph.vector(graph.param("alpha"), 1.0))
    inputs = {"p": np.ones((3, 5)), "t": np.arange(5.0)}
    values = Evaluator(roots)(inputs, PARAM_VALUES)
    assert [v.shape for v in values] == [(3, 5), (5,), (3, 5), (5,), (5,), (3, 1), (), (), (), (2, 1)]
    assert values[4].dtype == bool
    assert values[6] == pytest.approx(math.hypot(0.5, -1.25, 0.25))


def test_one_value_for_all_points() -> None:
    graph = FieldGraph()
    o, t = graph.input("o"), graph.input("t", Type.FLOAT)
    (value,) = Evaluator([o + t])({"o": np.array([[1.0], [2.0], [3.0]]), "t": np.arange(4.0)}, {})
    assert np.array_equal(value, np.array([[1.0], [2.0], [3.0]]) + np.arange(4.0))
    (empty,) = Evaluator([o + t])({"o": np.ones((3, 1)), "t": np.zeros(0)}, {})
    assert empty.shape == (3, 0)


def test_blocks_are_joined() -> None:
    root = spheres(5, to_the_right=False)
    positions = np.random.default_rng(2).normal(size=(3, 2 * numeric.BLOCK + 17))
    (whole,) = Evaluator([root])({"p": positions}, {})
    (last,) = Evaluator([root])({"p": positions[:, -20:]}, {})
    assert np.array_equal(whole[-20:], last)


def test_float32_stays_float32() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    third = graph.call(Op.ROUND, graph.select(p[0] < 0.0, p[1] / 3.0, graph.param("alpha")) * 7.1) + graph.length(p)
    (value,) = Evaluator([third], np.float32)({"p": np.ones((3, 4), np.float32)}, PARAM_VALUES)
    assert value.dtype == np.float32


@pytest.mark.parametrize("to_the_right", [False, True])
def test_few_values_are_alive_at_a_time(to_the_right: bool) -> None:
    evaluator = Evaluator([spheres(300, to_the_right)])
    positions = np.zeros((3, numeric.BLOCK))
    tracemalloc.start()
    evaluator({"p": positions}, {})
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16 * positions.nbytes


def test_deep_graphs_do_not_recurse() -> None:
    graph = FieldGraph()
    x = root = graph.input("t", Type.FLOAT)
    for _ in range(20_000):
        root = graph.min(root, x + 1.0) + 0.0001
    (value,) = Evaluator([root])({"t": np.zeros(2)}, {})
    assert value == pytest.approx([1.0001, 1.0001])


@given(st.sampled_from([Type.FLOAT, Type.VEC3]).flatmap(lambda t: trees(t)))
def test_the_order_of_evaluation_has_every_node_once_after_its_arguments(recipe: Recipe) -> None:
    root = recipe.build(FieldGraph())
    order = evaluation_order([root])
    assert {n.id for n in order} == {n.id for n in topological([root])}
    place = {n.id: i for i, n in enumerate(order)}
    assert len(place) == len(order)
    assert all(place[a.id] < place[n.id] for n in order for a in n.args)


@pytest.mark.parametrize("op", sorted(COMPARISON | LOGIC, key=lambda o: o.value))
def test_truth_tables(op: Op) -> None:
    graph = FieldGraph()
    a, b = (graph.input(name, Type.FLOAT) for name in "ab")
    args = (a, b) if op in COMPARISON else (graph.constant(0.5) < a, graph.constant(0.5) < b)
    root = graph.add(op, *args[:1]) if op is Op.NOT else graph.add(op, *args)
    (value,) = Evaluator([root])({"a": np.array([0.0, 0, 1, 1]), "b": np.array([0.0, 1, 0, 1])}, {})
    expected = {
        Op.LESS: [0, 1, 0, 0],
        Op.LESS_EQUAL: [1, 1, 0, 1],
        Op.EQUAL: [1, 0, 0, 1],
        Op.AND: [0, 0, 0, 1],
        Op.OR: [0, 1, 1, 1],
        Op.NOT: [1, 1, 0, 0],
    }
    assert value.tolist() == [bool(x) for x in expected[op]]


def test_simplifications_that_formulas_rely_on() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    x = p[0]
    assert p * 1.0 is p and p + 0.0 is p and p - 0.0 is p and p / 1.0 is p
    assert 0.0 * p is graph.constant(0.0, 0.0, 0.0)
    assert -graph.call(Op.NEG, x) is x and x - x is graph.constant(0.0) and x + (-x) is graph.constant(0.0)
    assert graph.vector(p[0], p[1], p[2]) is p and graph.vector(x, 2.0, x)[1] is graph.constant(2.0)
    assert p.swizzle("zyx").swizzle("zyx") is p
    assert graph.select(graph.boolean(True), x, p) is graph.vector(x, x, x)
    assert graph.constant(2.0) + graph.constant(3.0) is graph.constant(5.0)
    assert graph.constant(0.0) is not graph.constant(-0.0)
    assert node(Op.POW, number(2.0), number(10.0)).build(graph) is graph.constant(1024.0)
