"""`vec4 map_span(vec3 p, vec3 d, float ray_length)`: what `map` does along a piece of a ray (ALGORITHMS B3)."""

from __future__ import annotations

import math
from functools import cache

from sdfc.field.function import Function
from sdfc.field.graph import FieldGraph, Type
from sdfc.field.span import span
from sdfc.glsl.body import Body, own_direction, own_point
from sdfc.glsl.expression import literal, print_function
from sdfc.glsl.fold import Fold, Operations
from sdfc.glsl.functions import AHEAD, Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.glsl.names import identifier
from sdfc.plan.steps import Many, Part, Step, Within, may_flatten

_LENGTH = identifier(AHEAD)
_BOX_SPAN = "box_distance_span"
_STILL = "vec4(FAR, FAR, 0.0, 0.0)"


class SpanWriter:
    """Writes bounds of `map` and of its slope, over a piece of a ray of unit direction: union = min, leaf by leaf.

    `map` is at most the distance wherever it is positive. So no slope is told that is steeper than 1, not even where a
    leaf jumps: f > 0 up to f(p) / -lo holds there by the distance, and everywhere else by the slope.
    """

    def __init__(
        self, graph: FieldGraph, functions: Functions, live: Live, slopes: dict[int, float], many: ManyWriter
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._many = many
        self._slopes = slopes  # the Lipschitz constant of each part's formula, by id

    def write(self, root: Step) -> str:
        """The text of `map_span`, with what it calls that is not a part's own function."""
        body = Body(self._live)
        operations = Operations(
            "vec4", _STILL, "span_union", "span_intersection", self._value, self._many_span, self._within
        )
        result = Fold(operations).text(root, body)
        body.add(f"vec4 whole = {result};")
        body.add("return vec4(whole.xy, clamp(whole.zw, -1.0, 1.0));")
        head = f"vec4 map_span(vec3 p, vec3 d, float {_LENGTH}) {{"
        text = "\n".join([head, *body.lines, "}", ""])
        return f"{_box_span()}\n{text}" if _BOX_SPAN in text else text

    def _value(self, part: Part, body: Body, inside: bool) -> str:
        if not math.isfinite(self._slopes[id(part)]):
            return _STILL if inside else f"span_complement({_STILL})"
        q = body.point(own_point(part.inverse, self._graph.input("p")), f"q_{part.name}")
        dq = body.point(own_direction(part.inverse, self._graph.input("d")), f"d_{part.name}")
        text = body.call(self._functions.of_part(part, Role.SPAN), [q, dq, _LENGTH])
        scale = part.stretch * (1.0 / max(self._slopes[id(part)], 1e-9))
        if not (scale.is_constant and scale.number == 1.0):
            text = f"{body.text(scale)} * {text}"
        return text if inside else f"span_complement({text})"

    def _many_span(self, step: Many, body: Body, name: str) -> str:
        """Distances all: no dearer than the value, and what a ball says."""
        self._many.value(step, body, name)
        return f"vec4({name} - {_LENGTH}, {name} + {_LENGTH}, -1.0, 1.0)"

    def _within(self, step: Within, inner: str) -> str:
        if not step.is_needed:
            return f"span_intersection({_box(step)}, {inner})" if may_flatten(step) else inner
        margin = literal(1e-3 * step.box.radius)
        return f"span_within({_box(step)}, {inner}, {margin})"


def _box(step: Within) -> str:
    centre = ", ".join(literal(c) for c in step.box.centre)
    half = ", ".join(literal(h) for h in step.box.half)
    return f"{_BOX_SPAN}(p - vec3({centre}), d, {_LENGTH}, vec3({half}))"


@cache
def _box_span() -> str:
    """The function that gives the span of a box's distance (templates/lib/distance.glsl): the same in every scene."""
    graph = FieldGraph()
    p, d, half_size = (graph.input(n) for n in ("p", "d", "half_size"))
    length = graph.input(_LENGTH, Type.FLOAT)
    q = graph.abs(p) - half_size
    inside = graph.min(graph.max(q[0], graph.max(q[1], q[2])), 0.0)
    result = span(graph.length(graph.max(q, 0.0)) + inside, p, d, length).vector
    formal = (("p", Type.VEC3), ("d", Type.VEC3), (_LENGTH, Type.FLOAT), ("half_size", Type.VEC3))
    return print_function(Function(_BOX_SPAN, formal, result), _BOX_SPAN)
