"""The `proven` tracer's scene-dependent half: the step tree as GLSL."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.glsl.blend import BlendWriter
from sdfc.glsl.body import Body, own_direction, own_point
from sdfc.glsl.boxes import declare_box, declare_within
from sdfc.glsl.drawn import declare_across, drawn_next
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.glsl.parabola import parabola_next
from sdfc.glsl.piece import piece_next
from sdfc.glsl.scope import Intervals, Scope
from sdfc.plan.plan import FINE, SMALLEST_TOLERANCE
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
from sdfc.plan.touch import Side, are_thick_together, convex_of, is_grown, thickest_skin

# how much larger the solid is: a constant of the templates, and its sign
_SIZES = {Side.WHOLE: ("GROW", 1.0), Side.CORE: ("CUT", -1.0), Side.CUT: ("CUT", 1.0)}


@dataclass(frozen=True, slots=True)
class TraceText:
    """What templates/trace/proven.glsl includes: whole functions, and which of them there are."""

    functions: str
    events: bool
    march: bool


class ProvenWriter:
    """Writes `solid_n`, `events` and `march` for one step tree."""

    def __init__(self, graph: FieldGraph, functions: Functions, live: Live, many: ManyWriter) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._blends = BlendWriter(graph, functions, live)
        self._many = many
        self._o, self._d, self._p = (graph.input(n) for n in "odp")
        self._texts: list[str] = []
        self._count = 0

    def write(self, root: Step) -> TraceText:
        components = root.steps if isinstance(root, Any) else (root,)
        closed = [c for c in components if is_closed(c)]
        marched = [c for c in components if not is_closed(c)]
        if closed:
            self._events(closed)
        if marched:
            self._march(marched[0] if len(marched) == 1 else Any(tuple(marched)))
        return TraceText(
            "\n".join([*self._many.meetings, *self._blends.texts, *self._texts]), bool(closed), bool(marched)
        )

    # events: hard CSG of closed-form intervals

    def _events(self, components: list[Step]) -> None:
        body = Body(self._live)
        body.add("float first = FAR;")
        solids: list[Step] = []
        for component in components:
            match component:
                case Closed(inside=True):
                    text = f"enter({self._interval_text(body, component.part)}, start)"
                    body.add(f"first = min(first, {text});", component.part.span)
                case Many():
                    self._many.meet(component, body)
                case _:
                    solids.append(component)
        if solids:
            self._solids(solids)
            body.add("first = min(first, solids(o, d, start));")
        body.add("return first;")
        self._function(
            "float events(vec3 o, vec3 d, float start)", body, "the first hit of what is solved in closed form"
        )

    def _solids(self, components: list[Step]) -> None:
        """One loop for all: LLVM's time doubles with every loop of a shader (llvmpipe). What has hit stays."""
        body = Body(self._live)
        intervals = self._intervals(body, Any(tuple(components)))
        numbers = range(1, len(components) + 1)
        inner = Body(self._live, 2)
        inner.add("moved = false;")
        for number, component in zip(numbers, components, strict=True):
            inner.add(f"t = next_{number};")
            inner.add(f"next_{number} = {self._next(component, Scope(inner, intervals, {}, {}))};")
            inner.add(f"moved = moved || (next_{number} > t && next_{number} < FAR);")
        inner.add("steps += 1.0;")
        for number, component in zip(numbers, components, strict=True):
            body.add(f"float next_{number} = {self._start(component, intervals)};")
        body.add("float t;")
        body.add("bool moved;")
        body.add("do {")
        body.lines += inner.lines
        body.add("} while (moved);")
        body.add("float first = next_1;")
        for number in numbers[1:]:
            body.add(f"first = min(first, next_{number});")
        body.add("return first;")
        self._function("float solids(vec3 o, vec3 d, float start)", body, "each cut solid from one event to the next")

    def _intervals(self, body: Body, step: Step) -> Intervals:
        """Declares the ray's intervals with every solid of closed form below `step`; others as they are asked for."""
        intervals = Intervals(body, {})
        for leaf in leaves_of(step):
            match leaf:
                case Closed(inside=True):
                    self._named(leaf, intervals, Side.WHOLE)
                case _:
                    pass
        return intervals

    def _asked(self, leaf: Closed, scope: Scope) -> str:
        """The name of the ray's intervals with a leaf that a place in the tree is about."""
        if leaf.inside:
            return self._named(leaf, scope.intervals, Side.CORE if scope.core else Side.WHOLE, scope.skin)
        return self._named(leaf, scope.intervals, Side.CUT, scope.skin)

    def _named(self, leaf: Closed, intervals: Intervals, side: Side, skin: Expr | None = None) -> str:
        part, body, names = leaf.part, intervals.body, intervals.names
        key = id(part), side, -1 if skin is None or side is Side.WHOLE else skin.id
        if key not in names:
            like = sum((id(part), side) == other[:2] for other in names)
            name = f"{part.name}{side.value}{f'_{like + 1}' if like else ''}"
            text = self._interval_text(body, part, side, skin)
            body.declare(Type.VEC2 if leaf.intervals == 1 else Type.VEC4, name, text, part.span)
            names[key] = name
        return names[key]

    def _interval_text(self, body: Body, part: Part, side: Side = Side.WHOLE, skin: Expr | None = None) -> str:
        q = body.point(own_point(part.inverse, self._o), f"o_{part.name}")
        dq = body.point(own_direction(part.inverse, self._d), f"d_{part.name}")
        size, sign = _SIZES[side]
        own = sign * part.own_grow if skin is None or side is Side.WHOLE else sign * part.own_grow * skin
        grow = body.text(own * self._graph.input(size, Type.FLOAT))
        return body.call(self._functions.of_part(part, Role.RAY), [q, dq, grow])

    # marching: what has no closed form

    def _march(self, root: Step) -> None:
        body = Body(self._live)
        intervals = self._intervals(body, root)
        self._boxes(body, root)
        directions = self._directions(body, root)
        inner = Body(self._live, 2)
        inner.add("t = next;")
        inner.add("vec3 p = o + t * d;")
        inner.add("float eps = tolerance(t), fine = rounding(t);")
        text = f"next = {self._next(root, Scope(inner, intervals, directions, {}))};"
        if any("sunk" in line for line in [*inner.lines, text]):
            # where it arrives, not where it comes from: an eye far away must not step through what is thin
            inner.lines.insert(3, "        float sunk = 3.0 * rounding(max(t, 0.0));")
        inner.add(text)
        inner.add("steps += 1.0;")
        inner.add("evaluations += 1.0;")
        inner.add("count += 1;")
        body.add(f"float t, next = {self._start(root, intervals)};")
        body.add("do {")
        body.lines += inner.lines
        body.lines.insert(0, "    int count = 0;")
        body.add("} while (next > t && next < limit && count < MOST_STEPS);")
        body.add("unfinished = next > t && next < limit ? 1.0 : 0.0;")
        # at the limit of steps a hit is what converges: nearer than the pixel is wide (Keinert 2014, section 3.2)
        body.add(f"float near = {literal(1.0 / FINE)} * tolerance(t);")
        body.add("return next >= limit || next - t > near ? FAR : t;")
        self._function(
            "float march(vec3 o, vec3 d, float start, float limit)",
            body,
            "the first hit of what is marched, before `limit`",
        )

    def _boxes(self, body: Body, step: Step) -> None:
        match step:
            case Within():
                declare_within(self._graph, body, step)
                self._boxes(body, step.step)
            case Chord():
                # wider than what counts as there: a ray along a wall would creep, its chords ending where it is
                declare_box(body, f"box_{step.part.name}", step.part.box.widened(8.0 * SMALLEST_TOLERANCE))
                body.once(f"float most_{step.part.name} = FAR;")
            case Any() | All():
                for child in step.steps:
                    self._boxes(body, child)
            case Ball() if step.ahead:
                body.once(f"float {step.ahead} = FAR;")
            case Ball() if step.drawn is not None:
                declare_across(self._graph, body, step)
            case Closed() | Many() | Tangent() | Ball() | Blend():
                pass
            case _:
                assert_never(step)

    def _directions(self, body: Body, root: Step) -> dict[int, Expr]:
        """The ray's direction in the own space of each tangent's part: the same all along the ray."""
        found: dict[int, Expr] = {}
        for leaf in leaves_of(root):
            match leaf:
                case Tangent(part=part) | Chord(part=part):
                    parts = [part]
                case Ball(part=part) if leaf.bend is not None or leaf.ahead:
                    parts = [part]
                case Blend():
                    parts = self._blends.convex_parts_of(leaf)
                case _:
                    parts = []
            for part in parts:
                if id(part) not in found:
                    found[id(part)] = self._direction(body, part)
        return found

    def _direction(self, body: Body, part: Part) -> Expr:
        own = own_direction(part.inverse, self._d)
        if own is self._d:
            return own
        name = f"d_{part.name}"
        body.declare(Type.VEC3, name, body.text(own))
        return self._graph.input(name)

    def _start(self, step: Step, intervals: Intervals) -> str:
        """Where marching may begin: what boxes and closed-form parts prove before any value is known."""
        match step:
            case Closed(inside=True):
                return f"enter({self._named(step, intervals, Side.WHOLE)}, start)"
            case Within():
                return f"enter({step.name}, start)"
            case Any() if step.steps:
                return _chain("min", [self._start(s, intervals) for s in step.steps])
            case All():
                proved = [text for text in (self._start(s, intervals) for s in step.steps) if text != "start"]
                return _chain("max", proved) if proved else "start"
            case Closed() | Many() | Tangent() | Chord() | Ball() | Blend() | Any():
                return "start"
            case _:
                assert_never(step)

    # the tree

    def _next(self, step: Step, scope: Scope) -> str:
        match step:
            case Closed():
                return f"{'enter' if step.inside else 'leave'}({self._asked(step, scope)}, t)"
            case Many():
                raise AssertionError("many parts are members of the scene's union, which is solved by events")
            case Tangent() | Chord() | Ball() | Blend():
                return self._asked_once(step, scope)
            case Within():
                return f"inside({step.name}, t, {self._next(step.step, replace(scope, box=step.name))})"
            case Any():
                return self._joined("min", "near", [self._next(s, scope) for s in step.steps], scope)
            case All():
                return self._all(step, replace(scope, cut=True, skin=thickest_skin(step)))
            case _:
                assert_never(step)

    def _asked_once(self, step: Tangent | Chord | Ball | Blend, scope: Scope) -> str:
        """The answer; a name for it in an intersection that asks twice, of the solid and of its core."""
        if not scope.twice:
            return self._marched(step, scope)
        if id(step) not in scope.marched:
            self._count += 1
            scope.marched[id(step)] = name = f"near_{self._count}"
            scope.body.add(f"float {name} = {self._marched(step, scope)};")
        return scope.marched[id(step)]

    def _marched(self, step: Tangent | Chord | Ball | Blend, scope: Scope) -> str:
        match step:
            case Tangent():
                value = self._blends.slope(scope.body, step.part, scope.directions[id(step.part)])
                return f"tangent(t, {f'vec2(sunk, 0.0) + {value}' if scope.cut else value}, fine)"
            case Chord():
                return self._chord(step, scope.body, scope.directions[id(step.part)])
            case Ball():
                return self._ball(step, scope)
            case Blend():
                return self._blends.next(scope.body, step, scope.directions, scope.cut)
            case _:
                assert_never(step)

    def _joined(self, operation: str, label: str, texts: list[str], scope: Scope) -> str:
        """The least or the greatest of texts: in a statement each where they are many."""
        if not texts:
            return "FAR"
        if len(texts) <= 3:
            return _chain(operation, texts)
        self._count += 1
        name = f"{label}_{self._count}"
        scope.body.add(f"float {name} = {texts[0]};")
        for text in texts[1:]:
            scope.body.add(f"{name} = {operation}({name}, {text});")
        return name

    # intersections: the parts that are grown, and the rest

    def _all(self, step: All, scope: Scope) -> str:
        convex = convex_of(step.steps)
        others = [s for s in step.steps if s not in convex]
        grown = [partial(self._convex, convex)] if convex else []
        grown += [partial(self._next, s) for s in others if is_grown(s)]
        texts = [self._met(grown, scope)] if len(grown) > 1 and not scope.core else [ask(scope) for ask in grown]
        texts += [self._next(s, scope) for s in others if not is_grown(s)]
        return self._joined("max", "far", texts, scope)

    def _met(self, grown: Sequence[Callable[[Scope], str]], scope: Scope) -> str:
        """What is in all, and but for one of them in their cores: the least of the greatest, part by part."""
        scope = replace(scope, twice=True)
        deep = replace(scope, core=True)
        met, core = grown[0](scope), grown[0](deep)
        for ask in grown[1:]:
            self._count += 1
            name = f"far_{self._count}"
            whole, other = ask(scope), ask(deep)
            scope.body.add(f"float {name} = min(max({met}, {other}), max({core}, {whole}));")
            met, core = name, f"max({core}, {other})"
        return met

    def _convex(self, steps: list[Closed], scope: Scope) -> str:
        """The convex parts: they meet in one interval first."""
        names = [self._asked(s, scope) for s in steps]
        if scope.core or len(steps) == 1 or are_thick_together([s.part for s in steps]):
            return f"enter({_chain('both', names)}, t)"
        cores = [self._asked(s, replace(scope, core=True)) for s in steps]
        pairs = [f"vec4({name}, {core})" for name, core in zip(names, cores, strict=True)]
        return f"enter({_chain('meeting', pairs)}.xy, t)"

    def _chord(self, step: Chord, body: Body, direction: Expr) -> str:
        """The value is looked at once more, on the way to where the tangent (or the part's box) ends."""
        part, name = step.part, step.part.name
        body.once(f"vec2 v_{name}_chord = {self._blends.slope(body, part, direction)};", part.span)
        body.once(f"float reach_{name} = chord_reach(t, v_{name}_chord, box_{name}.y, most_{name}, fine);")
        end = self._graph.input(f"p_{name}")
        body.once(f"vec3 p_{name} = p + reach_{name} * d;")
        q = body.point(own_point(part.inverse, end), f"q_{part.name}_end")
        text = body.call(self._functions.of_part(part, Role.SLOPE), [q, body.text(direction)])
        scale = "" if part.stretch.is_constant and part.stretch.number == 1.0 else f"{body.text(part.stretch)} * "
        seen = f"v_{name}_chord.x, reach_{name}, {scale}{text}.x"
        body.once(f"float out_{name} = chord(t, {seen}, fine, most_{name});", part.span)
        return f"out_{name}"

    def _ball(self, step: Ball, scope: Scope) -> str:
        part, body = step.part, scope.body
        if step.ahead:
            direction = scope.directions[id(part)]
            return piece_next(self._graph, self._functions, body, step, direction, scope.box, scope.cut)
        if step.bend is not None:
            direction = scope.directions[id(part)]
            return parabola_next(self._graph, self._functions, body, step, direction, scope.cut)
        q = body.point(own_point(part.inverse, self._p), f"q_{part.name}")
        value = body.call(self._functions.of_part(part, Role.VALUE), [q])
        scale = part.stretch * (1.0 / max(step.lipschitz, 1e-9))
        if not (scale.is_constant and scale.number == 1.0):
            value = f"{body.text(scale)} * {value}"
        eps = "fine" if scope.cut else "eps"
        sunk = "sunk + " if scope.cut else ""
        if step.drawn is not None:
            return drawn_next(body, step, step.drawn, q, f"{sunk}{value}", eps)
        if step.inside:
            return f"ball(t, {sunk}{value}, {eps})"
        return f"ball(t, 3.0 * {eps} - {value}, {eps})"

    def _function(self, head: str, body: Body, doc: str) -> None:
        self._texts.append("\n".join([f"// {doc}", head + " {", *body.lines, "}", ""]))


def _chain(operation: str, texts: list[str]) -> str:
    result = texts[0]
    for text in texts[1:]:
        result = f"{operation}({result}, {text})"
    return result
