"""`float map(vec3 p)`: at most the distance to the surface, with the right sign."""

from __future__ import annotations

import math
from typing import assert_never

from sdfc.diagnostics import Span
from sdfc.field.graph import FieldGraph
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.plan.steps import All, Any, Ball, Blend, Chord, Closed, Many, Part, Step, Tangent, Within, may_flatten


class DistanceWriter:
    """Writes one scene's distance, as a chain of statements, one a part.

    Where it only tells how open the sky is, a part whose value means something only in its box is ignored outside:
    the distance to that box, though a bound, would show as a shadow of the box.
    """

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        slopes: dict[int, float],
        many: ManyWriter,
        traced: bool,
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._many = many
        self._traced = traced
        self._slopes = slopes  # the Lipschitz constant of each part's formula, by id
        self._count = 0

    def write(self, root: Step) -> str:
        body = Body(self._live)
        result = self._fold(root, body)
        body.add(f"return {result};")
        return "\n".join(["float map(vec3 p) {", *body.lines, "}", ""])

    def _fold(self, step: Step, body: Body) -> str:
        match step:
            case Closed() | Ball():
                return self._value(step.part, body, step.inside)
            case Tangent() | Blend():
                return self._value(step.part, body, True)
            case Many():
                self._count += 1
                self._many.value(step, body, f"d{self._count}")
                return f"d{self._count}"
            case Chord():
                return self._value(step.part, body, False)
            case Within():
                return self._within(step, body) if step.is_needed else self._bounded(step, body)
            case Any():
                return self._joined("min", step.steps, body)
            case All():
                return self._joined("max", step.steps, body)
            case _:
                assert_never(step)

    def _joined(self, operation: str, steps: tuple[Step, ...], body: Body) -> str:
        if not steps:
            return "FAR"
        self._count += 1
        name = f"d{self._count}"
        first = self._fold(steps[0], body)
        body.add(f"float {name} = {first};", _span(steps[0]))
        for step in steps[1:]:
            text = self._fold(step, body)
            body.add(f"{name} = {operation}({name}, {text});", _span(step))
        return name

    def _value(self, part: Part, body: Body, inside: bool) -> str:
        if not math.isfinite(self._slopes[id(part)]):
            return "FAR" if inside else "-FAR"  # no bound is known: it shades nothing around it
        q = body.point(own_point(part.inverse, self._graph.input("p")), f"q_{part.name}")
        text = body.call(self._functions.of_part(part, Role.VALUE), [q])
        scale = part.stretch * (1.0 / max(self._slopes[id(part)], 1e-9))
        if not (scale.is_constant and scale.number == 1.0):
            text = f"{body.text(scale)} * {text}"
        return text if inside else f"-{text}" if "*" not in text else f"-({text})"

    def _within(self, step: Within, body: Body) -> str:
        """Outside its box a part's own value may mean nothing: there the distance to the box is the bound."""
        inner = self._fold(step.step, body)
        margin = literal(1e-3 * step.box.radius)
        outside = "box_distance" if self._traced else "far_outside"
        return f"within({outside}({_place(step)}), {inner}, {margin})"

    def _bounded(self, step: Within, body: Body) -> str:
        """A value that holds everywhere, but may be small far away: to trace by it, the greater of two bounds."""
        inner = self._fold(step.step, body)
        return f"max({inner}, box_distance({_place(step)}))" if self._traced and may_flatten(step) else inner


def _place(step: Within) -> str:
    centre = ", ".join(literal(c) for c in step.box.centre)
    half = ", ".join(literal(h) for h in step.box.half)
    return f"p - vec3({centre}), vec3({half})"


def _span(step: Step) -> Span | None:
    match step:
        case Closed() | Tangent() | Chord() | Ball() | Blend():
            return step.part.span
        case Within() | Any() | All() | Many():
            return None
        case _:
            assert_never(step)
