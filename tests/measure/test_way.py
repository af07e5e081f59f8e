"""Ways to trace that are asked for in words."""

from __future__ import annotations

import pytest

from sdfc.api.request import RequestError
from sdfc.measure.way import way, ways
from sdfc.pipeline import Options


def test_a_way_has_one_name_however_it_is_asked_for() -> None:
    assert [w.name for w in ways(("proven+rays+prepass", "proven", "proven"))] == ["proven+prepass+rays", "proven"]
    assert way("proven+rays+prepass").options == Options("proven", rays="all", prepass=True)


def test_a_number_may_have_a_plus_in_it() -> None:
    found = way("relaxed:force=1e+09+prepass")
    assert found == way(found.name) and found.options == Options("relaxed:force=1e+09", prepass=True)


def test_what_the_planner_chooses_is_not_known_before_the_scene() -> None:
    assert way("auto").options is None


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("prove", r"no tracer 'prove' \(did you mean 'proven'\?\)"),
        ("proven+prepas", r"no addition to a tracer 'prepas' \(did you mean 'prepass'\?\)"),
        ("auto+rays", "'auto' chooses what goes with its tracer"),
        ("sphere:omega=2", "no parameter 'omega'"),
    ],
)
def test_what_cannot_be_is_said(spec: str, message: str) -> None:
    with pytest.raises(RequestError, match=message):
        way(spec)
