"""`float map(vec3 p)`: at most the distance to the surface, with the right sign."""

from __future__ import annotations

import math

from sdfc.field.graph import FieldGraph
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal
from sdfc.glsl.fold import Fold, Operations
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.plan.steps import Many, Part, Step, Within, may_flatten

_ROUNDING = 2.0**-26  # of a box's size: float32 knows no smaller part of it


class DistanceWriter:
    """Writes one scene's distance, as a chain of statements, one a part.

    Where it only tells how open the sky is, a part whose value means something only in its box is ignored outside:
    the distance to that box, though a bound, would show as a shadow of the box. What is farther than the height that is
    asked about hides nothing: of a table, only the groups that are nearer are looked through.
    """

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        slopes: dict[int, float],
        many: ManyWriter,
        traced: bool,
        is_steady: bool = False,
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._many = many
        self._traced = traced
        self.is_limited = False  # whether the function is told, besides, how near a part must be to count
        self._within_box = "within_steadily" if is_steady else "within"  # others march it: no jumps
        self._slopes = slopes  # the Lipschitz constant of each part's formula, by id

    def write(self, root: Step, name: str = "map") -> str:
        body = Body(self._live)
        operations = Operations("float", "FAR", "min", "max", self._value, self._least, self._within)
        result = Fold(operations).text(root, body)
        body.give(result)
        limit = ", float limit" if self.is_limited else ""
        return "\n".join([f"float {name}(vec3 p{limit}) {{", *body.written(), "}", ""])

    def _value(self, part: Part, body: Body, inside: bool) -> str:
        if not math.isfinite(self._slopes[id(part)]):
            return "FAR" if inside else "-FAR"  # no bound is known: it shades nothing around it
        q = body.point(own_point(part.inverse, self._graph.input("p")), f"q_{part.name}")
        text = body.call(self._functions.of_part(part, Role.VALUE), [q])
        scale = part.stretch * (1.0 / max(self._slopes[id(part)], 1e-9))
        if not (scale.is_constant and literal(scale.number) == "1.0"):
            text = f"{body.text(scale)} * {text}"
        return text if inside else f"-{text}" if "*" not in text else f"-({text})"

    def _least(self, step: Many, body: Body, name: str) -> str:
        self.is_limited = not self._traced
        self._many.value(step, body, name, "limit" if self.is_limited else "FAR")
        return name

    def _within(self, step: Within, inner: str) -> str:
        """Outside its box a part's own value may mean nothing: there the distance to the box is the bound.

        Where it holds everywhere but may be small far away, it is traced by the greater of two bounds.
        """
        if not step.is_needed:
            is_bounded = self._traced and may_flatten(step)
            return f"max({inner}, box_distance({_place(step)}))" if is_bounded else inner
        margin = literal(1e-3 * step.box.radius)
        outside = "box_distance" if self._traced else "far_outside"
        return f"{self._within_box}({outside}({_place(step)}), {inner}, {margin})"


def _place(step: Within) -> str:
    half = step.box.half
    centre = [c if abs(c) > _ROUNDING * max(half) else 0.0 for c in step.box.centre]
    point = f"p - vec3({', '.join(map(literal, centre))})" if any(centre) else "p"
    return f"{point}, vec3({', '.join(map(literal, half))})"
