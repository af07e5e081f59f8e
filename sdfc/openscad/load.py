"""OpenSCAD's flattened CSG to a scene."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from sdfc.diagnostics import SceneError, Source, Span, scene_error
from sdfc.field.graph import FieldGraph
from sdfc.openscad import colors, plane
from sdfc.openscad.context import Context
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.modules import MODULES
from sdfc.openscad.parse import parse
from sdfc.openscad.part import Flat, Part, Solid
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.syntax import Call
from sdfc.openscad.tower import Tower
from sdfc.scene.library import Library
from sdfc.scene.model import Scene
from sdfc.shape.graph import Shape, ShapeGraph

UP = (0.0, 0.0, 1.0)
THICKNESS = 1.0  # of a file that is all in the plane, as in OpenSCAD's preview


def load(source: Source) -> Scene:
    """The scene of a `.csg` file. Raises SceneError with what is wrong or has no exact form, and where."""
    values = FieldGraph()
    context = Context(source, values, ShapeGraph(), Library(values))
    calls = parse(source)
    chosen = next((call for call in _all(calls) if "!" in call.modifiers), None)
    whole = Call("group", "", (), calls if chosen is None else (chosen,), 0, min(1, len(source.text)))
    root = _root(context, _evaluate(context, whole), whole.span(source))
    paint = colors.material(context, colors.PLAIN)
    return Scene(
        source=source,
        values=values,
        shapes=context.shapes,
        root=context.shapes.paint(paint, root, root.span),
        warnings=tuple(context.warnings),
        up=UP,
        files=(source.name,),
    )


def _all(calls: tuple[Call, ...]) -> Iterator[Call]:
    """Every call, in the order of the text."""
    stack = list(reversed(calls))
    while stack:
        call = stack.pop()
        yield call
        stack.extend(reversed(call.children))


def _root(context: Context, part: Part | None, span: Span) -> Shape:
    match part:
        case None:
            context.warn("nothing remains of this file", span)
            return context.shapes.nothing(span)
        case Solid():
            return part.shape
        case Flat():
            context.warn("this file is all in the plane: it is shown 1 thick, as OpenSCAD shows it", span)
            tower = Tower(context, span, -0.5 * THICKNESS, 0.5 * THICKNESS, 1.0, 1.0)
            return plane.fold(part.plane, tower.solid)


def _evaluate(context: Context, root: Call) -> Part | None:
    """Children before parents, without recursion; the colour that is outermost rules."""
    results: list[Part | None] = []
    stack: list[tuple[Call, bool, bool]] = [(root, False, False)]
    while stack:
        call, is_painted, expanded = stack.pop()
        kept = call.shown
        if expanded:
            first = len(results) - len(kept)
            children = results[first:]
            del results[first:]
            results.append(_build(context, call, children, is_painted))
            continue
        stack.append((call, is_painted, True))
        below = is_painted or (call.name == "color" and colors.has_color(_invocation(context, call, [], False)))
        stack.extend((child, below, False) for child in reversed(kept))
    return results[0]


def _invocation(context: Context, call: Call, children: list[Part | None], is_painted: bool) -> Invocation:
    return Invocation(call, context, children, MODULES[call.name].positional, is_painted)


def _build(context: Context, call: Call, children: list[Part | None], is_painted: bool) -> Part | None:
    module = MODULES.get(call.name)
    if module is None:
        raise _unknown(context, call)
    try:
        return module.build(_invocation(context, call, children, is_painted))
    except RefusalError as refusal:
        raise scene_error(refusal.message, call.span(context.source), refusal.hint) from None


def _unknown(context: Context, call: Call) -> SceneError:
    near = difflib.get_close_matches(call.name, MODULES, 1)
    hint = f"did you mean `{near[0]}`?" if near else "flatten a model with `openscad -o model.csg model.scad`"
    return scene_error(f"`{call.name}` is not one of OpenSCAD's modules", call.span(context.source), hint)
