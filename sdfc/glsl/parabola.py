"""Fields whose bend is bounded: stepped to the root of a parabola below them, or by the ball where that is more."""

from __future__ import annotations

from sdfc.field.core import DEEP
from sdfc.field.graph import Expr, FieldGraph
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Functions, Role
from sdfc.plan.steps import Ball


def parabola_next(graph: FieldGraph, functions: Functions, body: Body, step: Ball, direction: Expr, cut: bool) -> str:
    """The text of a ball's answer, where its bend is known. `direction`: the ray's, in the part's own space."""
    assert step.bend is not None and step.inside
    part, name = step.part, f"v_{step.part.name}_bend"
    q = body.point(own_point(part.inverse, graph.input("p")), f"q_{part.name}")
    text = body.call(functions.of_part(part, Role.PARABOLA), [q, body.text(direction)])
    if not _is_one(part.stretch):
        text = f"{body.text(part.stretch)} * {text}"
    body.once(f"vec3 {name} = {text};", part.span)
    least = graph.constant(1.0 / max(step.lipschitz, 1e-9))
    radius = f"{name}.x" if _is_one(least) else f"{body.text(least)} * {name}.x"
    bend = graph.max(step.bend * part.own_grow * part.own_grow * part.stretch, 1e-6)
    if cut:
        deep = body.text(DEEP * part.stretch)
        per = literal(max(step.lipschitz, 1e-9) if step.is_core else 0.0)
        return f"sunk_parabola(t, {radius}, {name}.yz, {body.text(bend)}, {per}, sunk, {deep}, fine)"
    return f"parabola(t, {radius}, {name}.yz, {body.text(bend)}, eps)"


def _is_one(value: Expr) -> bool:
    return value.is_constant and value.number == 1.0
