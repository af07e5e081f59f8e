"""docs/tracers.md and `sdfc list tracers` show the table of tracers as it is; what is asked of a tracer is checked."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sdfc.api.inspect import listing
from sdfc.tracers import TRACERS, choice

PAGE = (Path(__file__).parent.parent / "docs" / "tracers.md").read_text()


def table(*rows: tuple[str, ...]) -> str:
    head, *body = rows
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ("---",) * len(head), *body))


def shown(name: str) -> str:
    (text,) = re.findall(rf"<!-- {name} -->\n(.*?)\n<!-- end -->", PAGE, re.DOTALL)
    return str(text)


def test_the_tracers() -> None:
    rows = [(f"`{t.name}`", t.doc, t.source, t.needs, t.guarantee) for t in TRACERS.values()]
    assert shown("tracers") == table(("tracer", "what it does", "source", "needs", "guarantees"), *rows)


def test_their_parameters() -> None:
    rows = [
        (f"`{t.name}:{p.name}`", f"{p.default:g}", f"{p.low:g} … {p.high:g}", p.doc)
        for t in TRACERS.values()
        for p in t.parameters
    ]
    assert shown("parameters") == table(("parameter", "default", "range", "what it is"), *rows)


def test_where_they_are_weak() -> None:
    reasons = {
        (t.name, why): [f for f, w in t.weak.items() if w == why] for t in TRACERS.values() for why in t.weak.values()
    }
    rows = [(f"`{name}`", ", ".join(families), why) for (name, why), families in reasons.items()]
    assert shown("weak") == table(("tracer", "families of `sdfc stress`", "why"), *rows)


def test_the_list_says_what_each_needs_and_gives() -> None:
    words = {use.partition(":")[0]: doc for use, doc in listing("tracers")}
    assert words.keys() == TRACERS.keys()
    for name, tracer in TRACERS.items():
        assert all(part in words[name] for part in (tracer.doc, tracer.source, tracer.needs, tracer.guarantee))


@pytest.mark.parametrize(
    ("spec", "complaint"),
    [
        ("relaxed:omega=2", "is from 1 to 1.99"),
        ("relaxed:reduce=0.5", "is a whole number"),
        ("liktor:refinements=nan", "is a whole number"),
        ("segment:growth=nan", "is from 1 to 8"),
        ("sphere:omega=1.2", "it has none"),
        ("enhanced:beta=0.3", "there are: omega, force, reduce"),
    ],
)
def test_a_parameter_out_of_range_is_refused(spec: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        choice(spec)


def test_a_choice_is_called_what_was_asked_for() -> None:
    for spec in (*TRACERS, "relaxed:omega=1.4", "liktor:min_step=2:plain=1"):
        assert choice(spec).spec == spec
    assert choice("relaxed:omega=1.2").spec == "relaxed"
