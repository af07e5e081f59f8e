"""The field graph itself: what is equal is one node, and nodes come in the order in which they were asked for."""

from __future__ import annotations

import math

import pytest
from field_trees import PARAM_VALUES, Recipe, trees
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.field.graph import Expr, FieldGraph, Op, Type, inputs_of, substitute, topological
from sdfc.field.interval import ConstantBounds, IntervalEvaluator


def test_zeros_have_signs_and_every_nan_is_one() -> None:
    graph = FieldGraph()
    assert graph.constant(0.0) is graph.constant(0) is not graph.constant(-0.0)
    assert math.copysign(1.0, graph.constant(-0.0).number) == -1.0
    endless = graph.constant(math.inf)
    assert graph.constant(math.nan) is endless - endless is graph.constant(-math.nan)
    assert graph.constant(1.0, math.nan) is graph.constant(1.0, -math.nan) is not graph.constant(math.nan, 1.0)
    assert graph.boolean(True) is not graph.constant(1.0)
    assert graph.input("a") is not graph.param("a", Type.VEC3)


def test_what_was_asked_for_once_is_looked_up() -> None:
    graph = FieldGraph()
    x = graph.input("x", Type.FLOAT)

    def asked() -> list[Expr]:
        twice = graph.add(Op.NEG, graph.add(Op.NEG, x))
        return [x + 0.0, x * 2.0, graph.constant(2.0) * 3.0, twice, graph.vector(x, x, 1.0)[2]]

    first, count = asked(), len(graph)
    again = asked()
    assert [a is b for a, b in zip(first, again, strict=True)] == [True] * 5
    assert len(graph) == count
    assert first[0] is x is first[3] and first[2].number == 6.0 and first[4].number == 1.0


def test_only_constants_have_numbers() -> None:
    graph = FieldGraph()
    with pytest.raises(AttributeError):
        _ = graph.param("size").numbers


@given(tree=trees(Type.VEC3))
def test_nodes_are_after_their_arguments(tree: Recipe) -> None:
    """In the order of a walk by recursion, and by number."""
    root = tree.build(FieldGraph())
    walked: dict[Expr, None] = {}

    def walk(node: Expr) -> None:
        for argument in node.args:
            walk(argument)
        walked.setdefault(node)

    walk(root)
    assert topological([root]) == list(walked)
    assert topological([root, root.args[0] if root.args else root]) == list(walked)
    assert all(a.id < node.id for node in walked for a in node.args)


@settings(max_examples=100)
@given(recipes=st.lists(trees(Type.FLOAT), min_size=1, max_size=4))
def test_bounds_of_constants_are_those_of_intervals(recipes: list[Recipe]) -> None:
    """Bit for bit, whatever was asked before."""
    graph = FieldGraph()
    ranges = {"alpha": (0.25, 0.75), "beta": PARAM_VALUES["beta"]}
    bounds = ConstantBounds(ranges)
    for recipe in recipes:
        whole = recipe.build(graph)
        root = substitute(whole, {i: graph.constant(*[0.25] * i.type.size) for i in inputs_of(whole)})
        lo, hi = IntervalEvaluator(root).value({}, ranges)
        found = bounds(root)
        assert (found.lo.tolist(), found.hi.tolist()) == (lo.ravel().tolist(), hi.ravel().tolist())
