"""The scene in an origin and a unit of its own, so that float32 has all its digits wherever the author put it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sdfc.diagnostics import scene_error
from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box, nothing
from sdfc.facts.pointwise import is_pointwise
from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.graph import Affine, Apply, Shape, ShapeGraph
from sdfc.shape.matrix import Matrix, identity, scaling, translation

_NOISE = 1e-12  # of its size: where a scene is centred but for rounding, shaders say so
SMALLEST_RADIUS = 1e-100  # float64 still has the squares of what is scaled from it, and their inverses


@dataclass(frozen=True, slots=True)
class Frame:
    """The scene's own coordinates: (p - centre) / radius."""

    centre: tuple[float, float, float]
    radius: float
    box: Box  # of the finite parts, in the author's coordinates
    is_finite: bool  # whether the box holds the whole scene
    is_of_parts: bool = True  # else nothing finite has a size: the box is made up


def frame_of(root: Shape, bounds: Bounds) -> Frame:
    """From the scene's box, or, where that is infinite (a floor), from the box of its finite parts."""
    whole = bounds.box(root)
    box = whole if whole.is_finite else _finite_parts(root, bounds)
    if not box.is_finite or box.radius == 0.0:
        centre = box.centre if box.is_finite else (0.0, 0.0, 0.0)
        return Frame((centre[0], centre[1], centre[2]), 1.0, Box((-1.0,) * 3, (1.0,) * 3), False, False)
    if box.radius < SMALLEST_RADIUS:
        raise scene_error(f"the scene is less than {SMALLEST_RADIUS:g} across", root.span, "give it sizes nearer to 1")
    x, y, z = [c if abs(c) > _NOISE * box.radius else 0.0 for c in box.centre]
    return Frame((x, y, z), box.radius, box, whole.is_finite)


def is_plain(frame: Frame) -> bool:
    """Whether float32 has digits enough for the scene where it is: of middling size, and not far off its origin."""
    return 0.01 <= frame.radius <= 1000.0 and math.hypot(*frame.centre) <= 2.0 * frame.radius


def own_origin(root: Shape, graph: ShapeGraph, values: FieldGraph, frame: Frame) -> Shape:
    """Afterwards the scene lies in the unit ball (its finite parts do)."""
    x, y, z = frame.centre
    forward = scaling(values, *(3 * [1.0 / frame.radius])).after(translation(values, -x, -y, -z))
    inverse = translation(values, x, y, z).after(scaling(values, *(3 * [frame.radius])))
    return graph.affine(forward, inverse, root, root.span)


def _finite_parts(root: Shape, bounds: Bounds) -> Box:
    """The box of all nodes with a finite box that no such node holds, in the root's coordinates."""
    result = nothing()
    start = identity(bounds.values)
    stack: list[tuple[Shape, Matrix]] = [(root, start)]
    seen: set[tuple[Shape, tuple[Expr, ...]]] = set()
    while stack:
        shape, forward = stack.pop()
        key = (shape, forward.entries)
        if key in seen:
            continue
        seen.add(key)
        box = bounds.box(shape)
        if box.is_finite:
            moved = bounds.moved(forward, box)
            result = result.hull(moved) if moved.is_finite else result
            continue
        match shape:
            case Affine():
                stack.append((shape.child, forward.after(shape.forward)))
            case Apply() if not is_pointwise(shape, bounds.values):
                pass  # an operation may move its children anywhere
            case _:
                stack.extend((c, forward) for c in shape.children)
    return result
