"""What stands at the head of emitted GLSL: what it provides, what it needs, and what can be relied on."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, assert_never

from sdfc.glsl.targets.record import Brief, Control, Target


def header(brief: Brief, target: Target) -> list[str]:
    """Lines of words, without the marks of a comment."""
    what = {"field": "its signed distance field", "tracer": "its field and its tracer", "full": target.doc}[brief.part]
    lines = [f"{brief.title}: {what}. Made by sdfc."]
    lines += _provided(brief, target) if brief.part != "full" else [f"To use it: {target.use}."]
    return [*lines, *_needs(brief), *_place(brief), *_sure(brief)]


def _provided(brief: Brief, target: Target) -> list[str]:
    p = brief.prefix
    numbered = ", ".join(f"{i} {name or '(no name)'}" for i, name in enumerate(brief.materials))
    functions = [
        (f"float {p}_sdf(vec3 p)", "at most the distance to the surface, below 0 inside"),
        (f"vec3 {p}_gradient(vec3 p)", "its gradient: along the normal near the surface"),
        (f"int {p}_material(vec3 p)", numbered),
        (f"{p}_Properties {p}_properties(vec3 p)", "color (linear), metallic, roughness, emission, ..."),
    ]
    width = max(len(heading) for heading, _ in functions)
    lines = ["Provides", *(f"  {heading:{width}}  {words}" for heading, words in functions)]
    if brief.part == "tracer":
        lines += [
            f"  {p}_hit {p}_trace(vec3 origin, vec3 direction, float tmin, float tmax)",
            f"      found, t, position, normal, material, looks: what a ray meets first ({brief.tracer})",
            f"  {p}_hit {p}_trace_pixel(..., vec2 pixel)  the same, only as fine as the pixel needs: faster",
        ]
        if target.hands_state:
            lines.append(f"  both take an `inout {p}_State state` first, made by {p}_start_state()")
    return lines


def _needs(brief: Brief) -> list[str]:
    if not brief.controls:
        return ["Needs nothing."] if brief.part != "full" else []
    head = "Constants, to be changed by hand:" if brief.is_baked else "Needs"
    width = max(len(c.uniform) for c in brief.controls)
    kind = "" if brief.is_baked else "uniform "
    return [head, *(f"  {kind}{c.type} {c.uniform:{width}}  {range_of(c)}" for c in brief.controls)]


def range_of(control: Control) -> str:
    """`angle in radians, 0 to 6.28319, by default 0`."""
    unit = {"angle": "angle in radians", "color": "linear colour"}.get(control.unit, control.unit)
    low, high = control.low, control.high
    within = f", {low:g} to {high:g}" if low is not None and high is not None else ""
    return f"{unit}{within}, by default {numbers(control.default)}"


def _place(brief: Brief) -> list[str]:
    if not brief.has_box:
        return ["It is empty, or has no end: nothing in it has a size."]
    all_ = "All of it lies" if brief.is_finite else "It has no end; its finite parts lie"
    return [f"{all_} in {numbers(brief.low)} .. {numbers(brief.high)}, in the scene's units."]


def _sure(brief: Brief) -> list[str]:
    if brief.part == "full":
        return []
    slack = f"{2e-6 * math.dist(brief.low, brief.high):.1g}"
    lines = [f"The field's Lipschitz constant is 1: it never exceeds the distance by more than rounding ({slack})."]
    return lines + ([f"The tracer: {brief.guarantee}."] if brief.part == "tracer" else [])


def description(brief: Brief, sources: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """All of it for programs. `sources` by target and stage."""
    eye = brief.eye
    return {
        "made_by": "sdfc",
        "scene": brief.title,
        "part": brief.part,
        "prefix": brief.prefix,
        "unit": "the scene's own; angles in radians, colours linear",
        "up": list(brief.up),
        "bounds": {"low": list(brief.low), "high": list(brief.high), "holds_everything": brief.is_finite},
        "own_coordinates": {"centre": list(brief.centre), "radius": brief.radius},
        "lipschitz": 1.0,
        "guarantee": brief.guarantee,
        "materials": list(brief.materials),
        "camera": {
            "eye": list(eye.eye),
            "target": list(eye.target),
            "up": list(eye.up),
            "half_height" if eye.is_parallel else "tan_half_fov": eye.half,
            "uniforms_at_1280x720": {k: list(v) for k, v in brief.uniforms.items()} if brief.part == "full" else {},
        },
        "params": [
            {
                "param": c.param,
                "uniform": c.uniform,
                "type": c.type,
                "unit": c.unit,
                "default": list(c.default),
                "low": c.low,
                "high": c.high,
                "is_constant": brief.is_baked,
            }
            for c in brief.controls
        ],
        "functions": _signatures(brief),
        "sources": {target: dict(stages) for target, stages in sources.items()},
    }


def _signatures(brief: Brief) -> dict[str, str]:
    """The functions that a shader of yours calls; a whole shader has none."""
    p = brief.prefix
    functions = {
        "sdf": f"float {p}_sdf(vec3 p)",
        "gradient": f"vec3 {p}_gradient(vec3 p)",
        "material": f"int {p}_material(vec3 p)",
        "properties": f"{p}_Properties {p}_properties(vec3 p)",
    }
    trace = {"trace": f"{p}_hit {p}_trace(vec3 origin, vec3 direction, float tmin, float tmax)"}
    match brief.part:
        case "full":
            return {}
        case "tracer":
            return functions | trace
        case "field":
            return functions
        case _:
            assert_never(brief.part)


def numbers(values: Sequence[float]) -> str:
    """One number, or several in brackets."""
    texts = [f"{v:g}" for v in values]
    return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"
