"""Profiles that are drawn out: a step is a ball's, but as long as the ray goes across that far."""

from __future__ import annotations

from sdfc.field.graph import Expr, FieldGraph
from sdfc.glsl.body import Body, own_direction
from sdfc.plan.steps import Ball


def declare_across(graph: FieldGraph, body: Body, step: Ball) -> None:
    """How fast values may fall, the same all along a ray: by how far it goes across z for each unit of its length."""
    own = own_direction(step.part.inverse, graph.input("d"))
    across = step.part.stretch * graph.length(graph.vector(own[0], own[1]))
    body.once(f"float d_{step.part.name}_across = {body.text(across)};")


def drawn_next(body: Body, step: Ball, half: Expr, q: str, radius: str, eps: str) -> str:
    """The text of its answer. `q`: the point in the part's own space."""
    place = q if q.isidentifier() else f"({q})"
    scale = body.text(step.part.stretch * step.scale)
    beside = f"{scale} * (abs({place}.z) - {body.text(half)})"
    return f"drawn(t, {radius}, {beside}, d_{step.part.name}_across, {eps})"
