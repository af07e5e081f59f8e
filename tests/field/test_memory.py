"""What is remembered between compilations: the same questions, and no others."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from random_expressions import expressions

import sdfc
from sdfc.field.graph import Expr, FieldGraph, Op, topological
from sdfc.field.memory import MEMORY, Memory, fingerprint, params_fingerprint
from sdfc.field.show import show
from sdfc.field.steepness import gradient_bound

SCENES = Path(__file__).parent.parent.parent / "scenes"


def copied(root: Expr) -> Expr:
    """The same formula in a graph of its own, where ids are others."""
    graph = FieldGraph()
    graph.constant(17.0)
    made: dict[int, Expr] = {}
    for node in topological([root]):
        made[node.id] = graph._new(node.op, node.type, tuple(made[a.id] for a in node.args), node.value)
    return made[root.id]


@settings(max_examples=100, deadline=None)
@given(expressions(), expressions())
def test_fingerprints_tell_formulas_apart_and_graphs_not(one: Expr, other: Expr) -> None:
    assert fingerprint([one]) == fingerprint([copied(one)])
    same = show([copied(one)]) == show([copied(other)])
    assert (fingerprint([one]) == fingerprint([other])) == same


def test_fingerprints_know_signs_of_zero_params_and_which_root_is_asked_for() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    below, above = (graph.add(Op.ATAN2, graph.constant(zero), p[0]) for zero in (-0.0, 0.0))
    assert fingerprint([below]) != fingerprint([above])
    assert fingerprint([p[0] * graph.param("a")]) != fingerprint([p[0] * graph.param("b")])
    assert fingerprint([p[0], p[1]]) != fingerprint([p[1], p[0]])
    assert params_fingerprint({"a": (0.0, 1.0)}) == params_fingerprint({"a": [0.0, 1.0]})
    assert params_fingerprint({"a": (0.0, 1.0)}) != params_fingerprint({"a": (0.0, 2.0)})


def test_a_bound_is_of_its_own_box_and_ranges() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.dot(p, p) * graph.param("k")
    small, large = [1.0] * 3, [2.0] * 3
    first = gradient_bound(root, [0.0] * 3, small, [{"k": 1.0}])
    assert gradient_bound(root, [0.0] * 3, large, [{"k": 1.0}]) > 1.5 * first
    assert gradient_bound(root, [0.0] * 3, small, [{"k": 3.0}]) > 2.5 * first
    assert gradient_bound(root, [0.0] * 3, small, [{"k": 1.0}]) == first


def test_a_memory_forgets_what_was_not_asked_for_longest() -> None:
    memory: Memory = Memory(most=2)
    asked: list[str] = []

    def recall(question: str) -> int:
        def search() -> int:
            asked.append(question)
            return len(question)

        return memory.recall(question, search)

    assert [recall(q) for q in ("a", "bb", "a", "ccc", "a", "bb")] == [1, 2, 1, 3, 1, 2]
    assert asked == ["a", "bb", "ccc", "bb"]


@pytest.mark.parametrize("name", ["gyroid", "column", "heart"])
def test_an_edit_elsewhere_searches_for_nothing_again(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (SCENES / f"{name}.sdf").read_text()
    searches: list[str] = []
    recall = MEMORY.recall
    MEMORY.forget()
    monkeypatch.setattr(MEMORY, "recall", lambda q, search: recall(q, lambda: searches.append("one") or search()))

    def compiled(source: str) -> str:
        return sdfc.compile(source).compiled().glsl("radiance")

    first = compiled(text)
    assert searches
    searches.clear()
    edited = text.replace("scene {", "// a new line, and a new light\nlight { direction: [0, -1, 0] }\nscene {")
    assert compiled(edited) != first
    assert not searches
    assert compiled(text) == first
