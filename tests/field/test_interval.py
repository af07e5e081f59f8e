"""Interval evaluation must enclose: every operation, random expressions, slopes; and be of use."""

import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_expressions import BINARY, UNARY, expressions

from sdfc.field.graph import LEAVES, LOGIC, Expr, FieldGraph, Op, Type, topological
from sdfc.field.interval import IntervalEvaluator
from sdfc.field.interval_rules import RULES, Interval, cosine, modulo, multiplied, power, reciprocal, sine
from sdfc.field.interval_slopes import SLOPES
from sdfc.field.numeric import Evaluator
from sdfc.field.steepness import gradient_bound

SMOOTH = [Op.NEG, Op.ABS, Op.SIN, Op.COS, Op.ATAN, Op.SQRT, Op.EXP, Op.FLOOR, Op.SIGN, Op.ROUND, Op.TAN, Op.LOG]


def enclosed(lo: np.ndarray, hi: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Where each value is within its interval. NaN has no place to be; a pole is at either infinity (1 / -0.0)."""
    pole = np.isinf(values) & (np.isinf(lo) | np.isinf(hi))
    return np.isnan(values) | pole | ((lo <= values) & (values <= hi))


def test_every_operation_has_both_rules() -> None:
    assert set(RULES) | LEAVES == set(Op) == set(SLOPES) | LEAVES


def sampled(root: Expr, points: np.ndarray, params: dict[str, float]) -> np.ndarray:
    """The root's values; NaN also where only a part of it is (a comparison with NaN hides it)."""
    nodes = [node for node in topological([root]) if node.type is not Type.BOOL]
    values = [np.broadcast_to(v, (*v.shape[:-1], points.shape[1])) for v in Evaluator(nodes)({"p": points}, params)]
    broken = np.zeros(points.shape[1], bool)
    for value in values:
        broken |= np.isnan(value.reshape(-1, points.shape[1])).any(axis=0)
    return np.where(broken, np.nan, values[nodes.index(root)])


@settings(max_examples=500, deadline=None)
@given(
    expressions(),
    st.lists(st.sampled_from([0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 100.0]), min_size=3, max_size=3),
    st.sampled_from([0.0, 1e-12, 1e-3, 0.5, 1.0, 20.0]),
    st.integers(0, 2**31),
)
def test_values_enclose_samples(root: Expr, centre: list[float], radius: float, seed: int) -> None:
    lo = np.array(centre)[:, None] - radius
    hi = np.array(centre)[:, None] + radius
    params = {"k": 1.25}
    low, high = IntervalEvaluator(root).value({"p": (lo, hi)}, params)
    assert not np.isnan(low).any() and not np.isnan(high).any()
    share = np.random.default_rng(seed).choice([0.0, 0.25, 0.5, 1.0, 0.123, 0.9], (3, 200))
    points = np.clip(lo + share * (hi - lo), lo, hi)
    values = sampled(root, points, params)
    assert enclosed(low, high, values).all(), (low, high, values[~enclosed(low, high, values)])


@settings(max_examples=400, deadline=None)
@given(
    expressions(numbers=[0.0, 1.0, -1.0, 0.5, 2.0, 3.0, 0.1], unary=SMOOTH),
    st.lists(st.sampled_from([0.0, 1.0, -1.0, 0.3, -0.7]), min_size=6, max_size=6),
    st.sampled_from([1e-3, 0.1, 0.7]),
)
def test_slopes_enclose_chords(root: Expr, ray: list[float], width: float) -> None:
    """The mean value theorem: every chord's slope lies in the slope interval, unless it is unbounded."""
    o, d = np.array(ray[:3])[:, None], np.array(ray[3:])[:, None]
    slab = IntervalEvaluator(root).along_ray(o, d, np.array([0.25]), np.array([0.25 + width]), {"k": 0.75})
    t = np.linspace(0.25, 0.25 + width, 65)
    t[-1] = 0.25 + width
    values = sampled(root, o + t * d, {"k": 0.75})
    assume(not np.isnan(values).all())
    chords = np.diff(values) / np.diff(t)
    # values are rounded: a dozen operations on numbers up to the largest, divided by the step
    slack = 1e-12 * (1.0 + np.nanmax(np.abs(values)) + np.abs(chords)) / np.diff(t)
    good = np.isnan(chords) | ~np.isfinite(slack)
    good |= (chords >= slab.slope_lo - slack) & (chords <= slab.slope_hi + slack)
    assert good.all(), (chords[~good], slab)
    assert enclosed(slab.lo, slab.hi, values).all()


def component_cases() -> list[tuple[Op, float, float]]:
    return [(op, lo, lo + w) for op in UNARY for lo in (-4.0, -1.0, -0.5, 0.0, 0.4, 2.0) for w in (0.0, 0.3, 0.5, 3.0)]


@pytest.mark.parametrize("op", UNARY)
def test_a_unary_rule_encloses_and_is_tight(op: Op) -> None:
    graph = FieldGraph()
    evaluator = IntervalEvaluator(graph.add(op, graph.input("x", Type.FLOAT)))
    exact = Evaluator([evaluator.root])
    for _, lo, hi in [case for case in component_cases() if case[0] is op]:
        low, high = evaluator.value({"x": (lo, hi)})
        (values,) = exact({"x": np.linspace(lo, hi, 2001)})
        assert enclosed(low, high, values).all()
        seen = values[~np.isnan(values)]
        if seen.size and np.abs(seen).max() < 100.0 and op is not Op.LOG and low[0] > -np.inf:
            # no looser than the samples' spacing allows, apart from steps at an end point
            step = 1.0 if op is Op.ROUND else 0.06
            assert seen.min() - low[0] <= step and high[0] - seen.max() <= step


@pytest.mark.parametrize("op", BINARY)
def test_a_binary_rule_encloses_the_corners_and_the_inside(op: Op) -> None:
    graph = FieldGraph()
    root = graph.add(op, graph.input("x", Type.FLOAT), graph.input("y", Type.FLOAT))
    ends = [-3.0, -2.0, -0.5, -0.0, 0.0, 0.5, 1.0, 2.0, 7.0]
    pairs = [(a, b) for a in ends for b in ends if a <= b]
    x = np.array([p for p in pairs for _ in pairs]).T
    y = np.array([q for _ in pairs for q in pairs]).T
    low, high = IntervalEvaluator(root).value({"x": (x[0], x[1]), "y": (y[0], y[1])})
    assert not np.isnan(low).any() and not np.isnan(high).any()
    for s in (0.0, 0.2, 0.5, 1.0):
        for t in (0.0, 0.3, 0.5, 1.0):
            sample = {"x": x[0] + s * (x[1] - x[0]), "y": y[0] + t * (y[1] - y[0])}
            (values,) = Evaluator([root])(sample)
            assert enclosed(low, high, values).all()


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """The rules are called with numpy's warnings off."""
    with np.errstate(all="ignore"):
        yield


def interval(lo: float, hi: float) -> Interval:
    return Interval(np.array([lo]), np.array([hi]))


def test_rounding_is_outward_at_the_ends_of_the_number_range() -> None:
    tiny = multiplied(interval(1e-200, 1e-200), interval(1e-200, 2e-200))
    assert tiny.lo[0] <= 0.0 < tiny.hi[0]
    huge = multiplied(interval(1e200, 1e200), interval(1e200, 2e200))
    assert huge.lo[0] == np.finfo(float).max and huge.hi[0] == np.inf
    third = reciprocal(interval(3.0, 3.0))
    assert third.lo[0] < 1.0 / 3.0 < third.hi[0]
    assert third.hi[0] - third.lo[0] < 1e-15


def test_infinite_ends_are_large_numbers_not_nan() -> None:
    product = multiplied(interval(0.0, 1.0), interval(2.0, np.inf))
    assert product.lo[0] > -1e-300 and product.hi[0] == np.inf
    assert reciprocal(interval(0.0, 2.0)).lo[0] == pytest.approx(0.5)
    assert reciprocal(interval(-1.0, 2.0)) == (-np.inf, np.inf)


def test_waves_know_their_peaks() -> None:
    assert sine(interval(0.0, math.pi / 2)).hi[0] == 1.0
    assert sine(interval(0.1, 1.0)).hi[0] == pytest.approx(math.sin(1.0), abs=1e-14)
    assert cosine(interval(-0.1, 0.1)).hi[0] == 1.0
    assert cosine(interval(1e17, 1e17)) == (-1.0, 1.0)


def test_modulo_and_power_use_what_is_decided() -> None:
    assert modulo(interval(2.25, 2.5), interval(1.0, 1.0)).hi[0] == pytest.approx(0.5)
    assert modulo(interval(1.75, 2.25), interval(1.0, 1.0)).hi[0] == pytest.approx(1.0)
    assert power(interval(-2.0, 1.0), interval(2.0, 2.0)).lo[0] >= 0.0
    assert power(interval(-2.0, 1.0), interval(3.0, 3.0)).lo[0] == pytest.approx(-8.0)


def test_an_undecided_select_is_the_hull_and_its_slope_is_unbounded() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    evaluator = IntervalEvaluator(graph.select(p[0] < 0.5, 2.0, p[0] * 3.0))
    o, d = np.zeros((3, 3)), np.array([[1.0] * 3, [0.0] * 3, [0.0] * 3])
    slab = evaluator.along_ray(o, d, np.array([0.0, 0.0, 0.6]), np.array([0.4, 1.0, 0.7]))
    assert slab.lo.tolist() == pytest.approx([2.0, 0.0, 1.8]) and slab.hi.tolist() == pytest.approx([2.0, 3.0, 2.1])
    assert slab.slope_lo.tolist() == pytest.approx([0.0, -np.inf, 3.0])
    assert slab.slope_hi.tolist() == pytest.approx([0.0, np.inf, 3.0])


def test_a_select_between_constants_jumps() -> None:
    graph = FieldGraph()
    evaluator = IntervalEvaluator(graph.select(graph.add(Op.NOT, graph.input("p")[0] < 0.5), 2.0, 1.0))
    o, d = np.zeros((3, 2)), np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    slab = evaluator.along_ray(o, d, np.array([0.0, 0.0]), np.array([0.4, 1.0]))
    assert slab.slope_lo.tolist() == [0.0, -np.inf] and slab.hi.tolist() == [1.0, 2.0]


@pytest.mark.parametrize("op", [Op.FLOOR, Op.ROUND, Op.SIGN])
def test_a_step_has_no_slope_or_any(op: Op) -> None:
    graph = FieldGraph()
    evaluator = IntervalEvaluator(graph.add(op, graph.input("p")[0] - 0.25))
    o, d = np.zeros((3, 2)), np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    slab = evaluator.along_ray(o, d, np.array([0.3, 0.1]), np.array([0.4, 1.4]))
    assert (slab.slope_lo[0], slab.slope_hi[0]) == (0.0, 0.0)
    assert (slab.slope_lo[1], slab.slope_hi[1]) == (-np.inf, np.inf)


def test_length_keeps_its_slope_at_the_centre_of_a_sphere() -> None:
    graph = FieldGraph()
    evaluator = IntervalEvaluator(graph.length(graph.input("p")))
    d = np.array([[0.6], [0.0], [0.8]])
    slab = evaluator.along_ray(-2.0 * d, d, np.array([1.0]), np.array([3.0]))
    assert slab.slope_lo[0] == pytest.approx(-1.0) and slab.slope_hi[0] == pytest.approx(1.0)


def test_the_mean_value_form_narrows_a_cancelling_expression() -> None:
    graph = FieldGraph()
    x = graph.input("p")[0]
    evaluator = IntervalEvaluator(x * (x - 1.0) + 5.0 * x - 5.0 * x)
    o, d = np.zeros((3, 1)), np.array([[1.0], [0.0], [0.0]])
    ends = np.array([0.5]), np.array([0.51])
    plain, centred = evaluator.along_ray(o, d, *ends), evaluator.along_ray(o, d, *ends, centred=True)
    t = np.linspace(0.5, 0.51, 100)
    assert centred.lo[0] <= (t * t - t).min() and (t * t - t).max() <= centred.hi[0]
    assert centred.hi[0] - centred.lo[0] < 0.1 * (plain.hi[0] - plain.lo[0])


def test_params_may_be_intervals_and_many_points_go_in_chunks() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.length(p) - graph.param("r") + graph.param("shift", Type.VEC2)[1]
    evaluator = IntervalEvaluator(root)
    points = np.random.default_rng(3).uniform(-1, 1, (3, 20_001))
    lo, hi = evaluator.value({"p": (points, points)}, {"r": (0.5, 1.0), "shift": (1.0, 2.0)})
    expected = np.linalg.norm(points, axis=0)
    assert np.allclose(lo, expected + 1.0) and np.allclose(hi, expected + 1.5) and lo.shape == (20_001,)
    lo, hi = evaluator.value({"p": (points, points)}, {"r": 1.0, "shift": ((0.0, 0.0), (0.0, 1.0))})
    assert np.allclose(hi - lo, 1.0)


def test_a_constant_root_has_a_value_for_every_ray() -> None:
    graph = FieldGraph()
    slab = IntervalEvaluator(graph.constant(3.0)).along_ray(np.zeros((3, 5)), np.ones((3, 5)), np.zeros(5), np.ones(5))
    assert [end.shape for end in slab] == [(5,)] * 4
    assert slab.slope_hi.tolist() == [0.0] * 5


def test_logic_is_three_valued() -> None:
    graph = FieldGraph()
    x = graph.input("x", Type.FLOAT)
    condition = graph.add(Op.AND, x < 1.0, graph.add(Op.NOT, graph.add(Op.LESS_EQUAL, x, graph.constant(0.0))))
    lo, hi = IntervalEvaluator(condition).value(
        {"x": (np.array([0.2, 0.5, 2.0, -1.0]), np.array([0.8, 1.5, 3.0, 0.0]))}
    )
    assert (lo.tolist(), hi.tolist()) == ([1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0])
    assert condition.op in LOGIC


@settings(max_examples=300, deadline=None)
@given(
    expressions(numbers=[0.0, 1.0, -1.0, 0.5, 2.0, 3.0, 0.1]),
    st.lists(st.sampled_from([0.0, 1.0, -1.0, 0.3, -0.7]), min_size=6, max_size=6),
    st.sampled_from([1e-3, 0.1, 0.7]),
)
def test_both_sides_of_the_jumps_hold_every_value(root: Expr, line: list[float], width: float) -> None:
    o, d = np.array(line[:3])[:, None], np.array(line[3:])[:, None]
    ends = np.array([0.25]), np.array([0.25 + width])
    evaluator = IntervalEvaluator(root)
    lo, hi = evaluator.across_jumps(o, d, *ends, {"k": 0.75})
    plain = evaluator.along_ray(o, d, *ends, {"k": 0.75})
    values = sampled(root, o + np.linspace(0.25, 0.25 + width, 63)[1:-1] * d, {"k": 0.75})
    # where an argument stays at the jump itself, or sign's does, an isolated point is one of a kind
    assume(not any(node.op in (Op.SIGN, Op.EQUAL) for node in topological([root])))
    assert enclosed(lo, hi, values).all()
    # a divisor that jumps over zero is cut at zero by the plain rule, and need not be by the sides
    if not any(node.op is Op.DIV for node in topological([root])):
        assert (plain.lo <= lo).all() and (hi <= plain.hi).all()


def test_sides_of_a_jump_are_tight_and_independent() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    cell = graph.call(Op.MOD, p, 1.0) - 0.5
    evaluator = IntervalEvaluator(graph.max(graph.abs(cell[0]), graph.abs(cell[1])) + 0.0 * cell[2])
    o, d = np.array([[0.0], [0.0], [0.3]]), np.array([[1.0], [-1.0], [0.0]])
    ends = np.array([-1e-3]), np.array([1e-3])
    lo, hi = evaluator.across_jumps(o, d, *ends)
    assert lo[0] == pytest.approx(0.499) and hi[0] == pytest.approx(0.5)
    assert evaluator.along_ray(o, d, *ends).lo[0] == pytest.approx(0.0, abs=1e-12)
    everything = IntervalEvaluator(graph.length(graph.call(Op.FLOOR, graph.vector(p[0], p[0] + 2.0, p[0] + 4.0))))
    lo, hi = everything.across_jumps(o, d, np.array([-0.5]), np.array([0.5]))
    assert 3.1 < lo[0] < 3.2 and hi[0] == pytest.approx(np.sqrt(21.0))


def test_comparisons_of_the_same_values_agree_on_the_side() -> None:
    """y < 0 and y >= 0 flip together: their exclusive or never does, so the product of both signs is -1 throughout."""
    graph = FieldGraph()
    y, zero = graph.input("p")[1], graph.constant(0.0)
    below = graph.select(y < zero, 1.0, -1.0)
    above = graph.select(graph.add(Op.LESS_EQUAL, zero, y), 1.0, -1.0)
    again = graph.select(graph.add(Op.LESS_EQUAL, y, zero), 1.0, -1.0)
    o, d = np.zeros((3, 1)), np.array([[1.0], [1.0], [0.0]])
    lo, hi = IntervalEvaluator(below * above * below * again).across_jumps(o, d, np.array([-1.0]), np.array([1.0]))
    assert (lo[0], hi[0]) == (pytest.approx(-1.0), pytest.approx(-1.0))


def bound(build: Callable[[FieldGraph, Expr], Expr], lo: float = -2.0, hi: float = 2.0) -> float:
    graph = FieldGraph()
    return gradient_bound(build(graph, graph.input("p")), [lo] * 3, [hi] * 3)


def test_gradient_bounds_are_bounds_and_close() -> None:
    assert 1.0 <= bound(lambda g, p: g.length(p) - 1.0) < 1.03
    assert 7.0 <= bound(lambda g, p: 2.0 * p[0] + 3.0 * p[1] + 6.0 * p[2]) < 7.0001
    assert 2.0 * math.sqrt(12.0) <= bound(lambda g, p: g.dot(p, p)) < 7.0
    wave = bound(lambda g, p: g.length(p) + 0.1 * g.call(Op.SIN, 5.0 * p[0]) * g.call(Op.COS, 5.0 * p[1]))
    assert 1.3 < wave < 1.7


def test_a_gradient_bound_over_all_of_space_and_in_the_plane() -> None:
    assert bound(lambda g, p: g.length(p.swizzle("xz")) - 1.0, -np.inf, np.inf) < 1.03
    graph = FieldGraph()
    assert gradient_bound(graph.length(graph.input("p", Type.VEC2)), [-1.0, -1.0], [1.0, 1.0]) < 1.01


def test_what_jumps_or_is_steep_has_no_gradient_bound() -> None:
    assert bound(lambda g, p: g.call(Op.FLOOR, p[0])) == math.inf
    assert bound(lambda g, p: g.select(p[0] < 0.0, 1.0, 2.0)) == math.inf
    assert bound(lambda g, p: g.sqrt(p[1] + 2.0)) == math.inf
    assert bound(lambda g, p: g.length(p) * g.param("k")) == math.inf
    assert bound(lambda g, p: g.call(Op.MOD, p[0], 8.0), 1.0, 2.0) < 1.03


@settings(max_examples=100, deadline=None)
@given(
    expressions(numbers=[0.0, 1.0, 0.5, 2.0], unary=[Op.NEG, Op.ABS, Op.SIN, Op.COS, Op.ATAN]), st.integers(0, 2**31)
)
def test_no_chord_is_steeper_than_the_gradient_bound(root: Expr, seed: int) -> None:
    limit = gradient_bound(root, [-1.0] * 3, [1.0] * 3, [{"k": (0.5, 0.75)}, {"k": (0.75, 1.5)}], boxes=64)
    random = np.random.default_rng(seed)
    params = {"k": random.uniform(0.5, 1.5)}
    a = random.uniform(-1, 1, (3, 300))
    b = np.clip(a + random.choice([1e-3, 0.1, 2.0], 300) * random.normal(size=(3, 300)), -1, 1)
    rise = np.abs(sampled(root, a, params) - sampled(root, b, params))
    run = np.linalg.norm(a - b, axis=0)
    assert not (rise > limit * run * (1.0 + 1e-9) + 1e-9).any()


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(-1e200, 1e200).filter(lambda x: x == 0.0 or abs(x) > 1e-100), min_size=6, max_size=6))
def test_exact_rational_results_are_enclosed(numbers: list[float]) -> None:
    """Not only what float64 rounds to: the real number itself. (Where nothing underflows: no scene is that small.)"""
    graph = FieldGraph()
    x, y, w = graph.input("x", Type.FLOAT), graph.input("y", Type.FLOAT), graph.input("w", Type.VEC2)
    a, b, c, d = (Fraction(n) for n in numbers[:4])
    exact = {x + y: a + b, x - y: a - b, x * y: a * b, x * x: a * a, graph.dot(w, w): c * c + d * d}
    if b != 0:
        exact[x / y] = a / b
    inputs = {"x": (numbers[0],) * 2, "y": (numbers[1],) * 2, "w": (np.array(numbers[2:4])[:, None],) * 2}
    for root, value in exact.items():
        lo, hi = IntervalEvaluator(root).value(inputs)
        assert (lo[0] == -np.inf or Fraction(lo[0]) <= value) and (hi[0] == np.inf or value <= Fraction(hi[0]))
    lo, hi = IntervalEvaluator(graph.length(w)).value(inputs)
    assert Fraction(lo[0]) ** 2 <= c * c + d * d and (hi[0] == np.inf or c * c + d * d <= Fraction(hi[0]) ** 2)
