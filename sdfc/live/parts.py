"""The boxes of a scene's parts, with names that its author knows them by."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box
from sdfc.facts.pointwise import is_pointwise
from sdfc.facts.ranges import Range, Ranges
from sdfc.field.graph import Expr
from sdfc.pipeline import Compiled
from sdfc.shape.graph import Affine, Apply, Shape
from sdfc.shape.matrix import Matrix, identity

MOST_PARTS = 400
_MOST_VISITED = 20_000  # shapes, where few of them have a box: a part may be in many places


@dataclass(frozen=True, slots=True)
class Part:
    """A primitive, or what an operation that moves space makes of others; in the scene's units."""

    name: str
    box: Box


@dataclass(frozen=True, slots=True)
class Boxes:
    """The box of the whole scene, or of its finite parts, and those of its parts."""

    whole: Box
    parts: tuple[Part, ...]


def boxes_of(compiled: Compiled, exact: Mapping[str, tuple[float, ...]]) -> Boxes:
    """Boxes that hold what is there for all values of the params but those in `exact`, which have these values."""
    scene, frame = compiled.scene, compiled.frame
    ranges = {p.name: _range(p.default, p.low, p.high) for p in scene.params}
    bounds = Bounds(scene.values, Ranges(ranges | {name: (value, value) for name, value in exact.items()}))
    whole = bounds.box(scene.root).meet(frame.box) if frame.is_finite else frame.box
    parts = tuple(itertools.islice(_parts(scene.root, bounds), MOST_PARTS))
    return Boxes(frame.box if whole.is_empty else whole, parts)


def _range(default: tuple[float, ...], low: float | None, high: float | None) -> Range:
    if low is None or high is None:
        return default, default
    return (low,) * len(default), (high,) * len(default)


def _parts(root: Shape, bounds: Bounds) -> Iterator[Part]:
    """In the order of the text, each place of a part once; those without a finite box are left out."""
    stack: list[tuple[Shape, Matrix]] = [(root, identity(bounds.values))]
    seen: set[tuple[Shape, tuple[Expr, ...]]] = set()
    while stack and len(seen) < _MOST_VISITED:
        shape, forward = stack.pop()
        key = (shape, forward.entries)
        if key in seen:
            continue
        seen.add(key)
        match shape:
            case Affine():
                stack.append((shape.child, forward.after(shape.forward)))
            case Apply() if not _is_seen_through(shape, bounds):
                box = bounds.moved(forward, bounds.box(shape))
                if box.is_finite:
                    yield Part(_name(shape), box)
            case _:
                stack.extend((child, forward) for child in reversed(shape.children))


def _is_seen_through(shape: Apply, bounds: Bounds) -> bool:
    """Whether its children are parts of their own: those of a blend are, what is rounded is one part."""
    return len(shape.children) > 1 and is_pointwise(shape, bounds.values)


def _name(shape: Apply) -> str:
    """`box, die.sdf:35`: what it is made of, where that is one thing, and where it is written."""
    inner: Shape = shape
    named = shape
    while len(children := inner.children) == 1 and children[0].dimension == shape.dimension:
        inner = children[0]
        if isinstance(inner, Apply):
            named = inner
    line, _ = named.span.source.position(named.span.start)
    return f"{named.definition.name}, {named.span.source.name.rsplit('/', 1)[-1]}:{line}"
