"""The intervals of a ray with the boxes that parts are kept in: vec2s, declared before the loop that marches."""

from __future__ import annotations

import math

from sdfc.facts.box import Box
from sdfc.field.graph import FieldGraph
from sdfc.glsl.body import Body, own_direction, own_point
from sdfc.glsl.expression import literal
from sdfc.plan.steps import Within

_ENDLESS = 1e15  # radii to where there is no side: over the least direction that is told apart from 0, still a float32


def declare_box(body: Body, name: str, box: Box) -> None:
    """Of a box that has all its sides."""
    centre, half = (", ".join(map(literal, numbers)) for numbers in (box.centre, box.half))
    body.once(f"vec2 {name} = box_interval(o - vec3({centre}), d, vec3({half}));")


def declare_within(graph: FieldGraph, body: Body, step: Within) -> None:
    """Of the box that a step is kept in, in the space where it is; what has no end is not asked about."""
    if step.box.is_finite:
        declare_box(body, step.name, step.box)
        return
    o = body.point(own_point(step.inverse, graph.input("o")), f"o_{step.name}")
    d = body.point(own_direction(step.inverse, graph.input("d")), f"d_{step.name}")
    text = "vec2(-FAR, FAR)"
    for axis, low, high in zip("xyz", step.box.lo, step.box.hi, strict=True):
        if math.isfinite(low) or math.isfinite(high):
            ends = ", ".join(literal(min(max(end, -_ENDLESS), _ENDLESS)) for end in (low, high))
            text = f"both({text}, slab_interval({o}.{axis}, {d}.{axis}, vec2({ends})))"
    body.once(f"vec2 {step.name} = {text};")
