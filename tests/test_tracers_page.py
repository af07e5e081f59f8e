"""docs/tracers.md shows the table of tracers as it is."""

from __future__ import annotations

import re
from pathlib import Path

from sdfc.tracers import TRACERS

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
