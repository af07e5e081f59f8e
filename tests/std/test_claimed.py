"""Bounds of standard primitives in plain numbers are those that the graph folds, to the bit."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from standard_entries import names_where, subjects
from test_claims import checked

from sdfc.diagnostics import Source, Span
from sdfc.facts.claimed import claimed_corners
from sdfc.shape.graph import Apply, ShapeGraph
from sdfc.shape.lower import FORMAL

_PRIMITIVES = names_where(lambda d: d.is_primitive)
SPAN = Span(Source("test.sdf", ""), 0, 0)


@pytest.mark.parametrize("name", _PRIMITIVES)
@checked
@given(data=st.data(), level=st.sampled_from([0.0, -0.0, 0.25, -0.125, 1e-3]))
def test_corners_are_as_the_graph_folds_them(name: str, data: st.DataObject, level: float) -> None:
    subject = data.draw(subjects(name))
    shape = ShapeGraph().apply(subject.definition, subject.arguments.values(), (), SPAN)
    assert isinstance(shape, Apply)
    bounds = subject.definition.claims.bounds
    assert bounds is not None
    lo, hi = bounds(subject.arguments, {}, subject.graph.constant(level))
    found = claimed_corners(shape, level, subject.graph)
    assert (found is None) is any(p.kind not in FORMAL for p in subject.definition.values)
    assert found is None or repr(found) == repr((lo.numbers, hi.numbers))
