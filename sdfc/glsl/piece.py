"""Fields of whose slope bounds are known over the piece of the ray ahead: stepped as far as these prove it empty."""

from __future__ import annotations

from sdfc.field.graph import Expr, FieldGraph
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Functions, Role
from sdfc.plan.steps import Ball


def piece_next(
    graph: FieldGraph, functions: Functions, body: Body, step: Ball, direction: Expr, box: str, cut: bool
) -> str:
    """The text of a ball's answer that remembers how far ahead to look; not beyond its `box`.

    `direction`: the ray's, in the part's own space.
    """
    part, ahead = step.part, step.ahead
    eps = "fine" if cut else "eps"
    # from the start of its box on; powers of what is longer are no float32
    longest = f"min({box}.y - max(t, {box}.x), 1024.0)"
    body.once(f"{ahead} = max(min(t <= {box}.x ? FAR : {ahead}, {longest}), 4.0 * {eps});", part.span)
    q = body.point(own_point(part.inverse, graph.input("p")), f"q_{part.name}")
    scale = part.stretch if step.inside else -part.stretch
    before = "" if scale.is_constant and scale.number == 1.0 else f"{body.text(scale)} * "
    value = body.call(functions.of_part(part, Role.VALUE), [q])
    body.once(f"float v_{ahead} = {before}{value};", part.span)
    span = body.call(functions.of_part(part, Role.SPAN), [q, body.text(direction), ahead])
    body.once(f"vec4 span_{ahead} = {before}{span}{'' if step.inside else '.yxwz'};", part.span)
    least = literal(1.0 / max(step.lipschitz, 1e-9))
    # a hit on what is cut away lies inside it, by more than its own tolerance
    sunk = f"3.0 * {eps}" if not step.inside else "sunk" if cut else "0.0"
    return f"piece(t, {ahead}, v_{ahead}, span_{ahead}, {least}, {sunk}, {eps})"
