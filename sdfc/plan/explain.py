"""What was proved, and how each part will be traced, in words."""

from __future__ import annotations

import math
from typing import assert_never

from sdfc.passes.own_origin import Frame
from sdfc.plan.plan import Plan
from sdfc.plan.steps import (
    All,
    Any,
    Ball,
    Blend,
    Chord,
    Closed,
    Many,
    Part,
    Step,
    Tangent,
    Within,
    is_closed,
    leaves_of,
)
from sdfc.scene.model import Scene


def explain(scene: Scene, plan: Plan, frame: Frame) -> str:
    """Facts, the rule of each part with its reason, and what was left out."""
    leaves = leaves_of(plan.root)
    closed = sum(isinstance(leaf, Closed) for leaf in leaves)
    centre = ", ".join(f"{c:g}" for c in frame.centre)
    extent = "holds its finite parts; the scene itself has no end" if frame.is_of_parts else "nothing in it has a size"
    extent = "holds the whole scene" if frame.is_finite else extent
    lines = [
        f"scene: {scene.source.name}",
        f"bounds: centre [{centre}], radius {frame.radius:g}: {extent}",
        f"tracer: {plan.tracer.name}. {plan.tracer.doc} ({plan.tracer.source})",
        f"guarantee: {plan.tracer.guarantee}",
        f"parts: {len(leaves)}, of which {closed} with closed-form ray intervals"
        + (": no marching at all" if is_closed(plan.root) else ""),
        "steps:",
        *_tree(plan.root, 1),
    ]
    return "\n".join(lines)


def _tree(step: Step, depth: int) -> list[str]:
    pad = "  " * depth
    match step:
        case Any() | All():
            name = "union: the nearest of" if isinstance(step, Any) else "intersection: the farthest of"
            return [f"{pad}{name}", *(line for s in step.steps for line in _tree(s, depth + 1))]
        case Within():
            return [f"{pad}within {step.name}: outside it, the box's own interval", *_tree(step.step, depth + 1)]
        case Closed():
            side = "" if step.inside else "complement of "
            return [f"{pad}{side}{step.part.name} ({step.part.span}): closed form, {step.intervals} interval(s) a ray"]
        case Many():
            return [f"{pad}{len(step.members)} of {step.name}: closed form, 1 interval a ray; a row of a table each"]
        case Tangent():
            return [f"{pad}{step.part.name} ({step.part.span}): tangents, its function is convex{_left_out(step.part)}"]
        case Chord():
            reason = f"chords, its function is convex{_left_out(step.part)}"
            return [f"{pad}complement of {step.part.name} ({step.part.span}): {reason}"]
        case Ball():
            side = "" if step.inside else "complement of "
            reason = f"{_balls(step)}{_left_out(step.part)}"
            return [f"{pad}{side}{step.part.name} ({step.part.span}): {reason}"]
        case Blend():
            reason = "the blend of lines below its operands (tangents, where they are convex), which is concave"
            return [f"{pad}{step.part.name} ({step.part.span}): {reason}"]
        case _:
            assert_never(step)


def _left_out(part: Part) -> str:
    """A primitive with a ray claim is marched only where the claim is dear, and the options leave such claims out."""
    known = part.shape.definition.is_primitive and part.shape.definition.claims.ray is not None
    return "; a closed form is known, dearer here than marching" if known else ""


def _balls(step: Ball) -> str:
    why = f" ({step.why})" if step.why else ""
    if not math.isfinite(step.lipschitz):
        return f"bounds of its slope over the piece of the ray ahead{why}"
    balls = f"Lipschitz balls, constant {step.lipschitz:.4g}"
    if step.drawn is not None:
        return f"{balls}, stretched along the walls of what is drawn out{why}"
    if step.ahead:
        return f"{balls}, and bounds of its slope over the piece of the ray ahead{why}"
    if step.bend is None:
        return f"{balls}: nothing else is known that pays{why}"
    worst = f"at most {step.bend.number:.4g}" if step.bend.is_constant else "no more than the params' values say"
    return f"{balls}, and parabolas: it bends down by {worst}{why}"
