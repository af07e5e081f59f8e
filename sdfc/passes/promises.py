"""What holds after each pass: its docstring, as code. Asked by tests, of every scene and of random ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import MappingProxyType

from sdfc.facts.bounds import Bounds
from sdfc.passes.flatten import is_everything, is_nothing
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Nothing,
    Paint,
    Shape,
    Union,
    topological,
)
from sdfc.shape.stretch import is_similarity, smallest_stretch


def flattened(root: Shape) -> Iterator[str]:
    """A nest of one kind is one node, nothing is in it twice, and the empty solid is not in it."""
    for node in topological(root):
        match node:
            case Union() | Intersection():
                yield from _combination_faults(node)
            case Complement(child=Complement()):
                yield "a complement of a complement"
            case Affine() | Paint() if is_nothing(node.child) or is_everything(node.child):
                yield "the empty solid, moved or painted"
            case _:
                pass


def _combination_faults(node: Union | Intersection) -> Iterator[str]:
    if any(type(c) is type(node) for c in node.children):
        yield f"a {type(node).__name__} in a {type(node).__name__}"
    if len({c.id for c in node.children}) < len(node.children) or len(node.children) < 2:
        yield f"a {type(node).__name__} of less than two different parts"
    if any(is_nothing(c) or is_everything(c) for c in node.children):
        yield f"the empty solid in a {type(node).__name__}"


def painted(root: Shape) -> Iterator[str]:
    """A Paint has a primitive as its child, placed or not."""
    for node in topological(root):
        match node:
            case Paint(child=Apply() as leaf) | Paint(child=Affine(child=Apply() as leaf)):
                if not leaf.definition.is_primitive:
                    yield f"{leaf.definition.name} is painted as a whole"
            case Paint():
                yield f"a {type(node.child).__name__} is painted as a whole"
            case _:
                pass


def placed(root: Shape) -> Iterator[str]:
    """An Affine stands on an Apply, is not the identity, and does not scale what can be made larger itself."""
    for node in topological(root):
        match node:
            case Affine(child=Apply() as leaf):
                yield from _placing_faults(node, leaf)
            case Affine():
                yield f"a {type(node.child).__name__} is moved as a whole"
            case _:
                pass


def _placing_faults(node: Affine, leaf: Apply) -> Iterator[str]:
    numbers = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    if all(e.is_constant and e.number == n for e, n in zip(node.forward.entries, numbers, strict=True)):
        yield f"{leaf.definition.name} is moved to where it is"
    if leaf.definition.is_primitive and leaf.definition.claims.homogeneous:
        scale = smallest_stretch(node.forward, node.dimension)
        if scale.is_constant and scale.number != 1.0 and is_similarity(node.forward, node.dimension):
            yield f"{leaf.definition.name} is scaled by {scale.number}"


def negated(root: Shape) -> Iterator[str]:
    """A Complement stands on a leaf that has no dual itself: placed and painted or not."""
    for node in topological(root):
        match node:
            case Complement():
                yield from _complement_faults(node.child, True)
            case _:
                pass


def _complement_faults(shape: Shape, is_direct: bool) -> Iterator[str]:
    match shape:
        case Paint():
            yield from _complement_faults(shape.child, is_direct)
        case Affine():
            yield from _complement_faults(shape.child, False)
        case Apply():
            if is_direct and shape.definition.claims.dual is not None and shape.definition.is_standard:
                yield f"a complement of a {shape.definition.name}"
        case Nothing():
            pass
        case Union() | Intersection() | Complement():
            yield f"a complement of a {type(shape).__name__}"


def pruned(root: Shape, bounds: Bounds) -> Iterator[str]:
    """No part is empty, and nothing is subtracted out of reach; what operations are applied to is left alone."""
    stack = [] if is_nothing(root) else [root]
    while stack:
        node = stack.pop()
        if bounds.box(node).is_empty:
            yield f"an empty {type(node).__name__}"
        match node:
            case Intersection():
                box = bounds.box(node)
                cuts = [c.child for c in node.children if isinstance(c, Complement)]
                yield from (f"{cut.span} cuts nothing" for cut in cuts if bounds.box(cut).meet(box).is_empty)
                stack.extend(node.children)
            case Union() | Paint() | Affine():
                stack.extend(node.children)
            case _:
                pass


PROMISES: MappingProxyType[str, Callable[[Shape], Iterator[str]]] = MappingProxyType(
    {"flatten": flattened, "paint": painted, "place": placed, "negate": negated}
)
