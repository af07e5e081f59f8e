"""Random scenes as text, drawn by hypothesis from the grammar that `sdfc stress --random` grows."""

from __future__ import annotations

from hypothesis import strategies as st

from sdfc.measure.stress.trees import BALL, BLEND, CLOSED, KINDS, TANGENT, TWO_INTERVALS, VIEWS, Grower, table

__all__ = ["BALL", "BLEND", "CLOSED", "KINDS", "TANGENT", "TWO_INTERVALS", "VIEWS", "scenes", "table"]


@st.composite
def scenes(draw: st.DrawFn) -> str:
    """A whole scene: a tree, perhaps a table of many, perhaps a floor."""
    return Grower(lambda options: draw(st.sampled_from(list(options)))).scene()
