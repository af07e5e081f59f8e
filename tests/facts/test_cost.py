"""Law: a formula costs what it computes, each shared part once, and constants nothing."""

from __future__ import annotations

import pytest
from field_trees import Recipe, trees
from hypothesis import given

from sdfc.facts.cost import cost
from sdfc.field.graph import FieldGraph, Op


def test_what_is_shared_is_counted_once() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    far = graph.length(p)
    assert cost([far + 1.0]) == cost([far]) + 1.0
    assert cost([far * far]) == cost([far]) + 1.0
    assert cost([far, far]) == cost([far])


def test_places_and_numbers_are_free() -> None:
    graph = FieldGraph()
    assert cost([graph.input("p"), graph.constant(1.0, 2.0, 3.0), graph.input("p")[1]]) == 0.0


@given(trees())
def test_more_is_never_cheaper(recipe: Recipe) -> None:
    expression = recipe.build(FieldGraph())
    assert cost([expression]) >= max((cost([a]) for a in expression.args), default=0.0)


@pytest.mark.parametrize("dear, cheap", [(Op.SIN, Op.SQRT), (Op.SQRT, Op.ADD)])
def test_dear_functions_cost_more(dear: Op, cheap: Op) -> None:
    graph = FieldGraph()
    x = graph.input("p")[0]
    assert cost([graph.add(dear, x)]) > cost([graph.add(cheap, *[x, x][: 2 if cheap is Op.ADD else 1])])
