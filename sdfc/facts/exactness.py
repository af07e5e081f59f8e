"""How a field relates to the distance (the lattice of ALGORITHMS C1)."""

from __future__ import annotations

from typing import assert_never

from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, topological
from sdfc.shape.stretch import is_similarity

_E, _EO, _EI, _LB, _N = (
    Exactness.EXACT,
    Exactness.EXACT_OUTSIDE,
    Exactness.EXACT_INSIDE,
    Exactness.BOUND,
    Exactness.NONE,
)


def exactness(root: Shape) -> dict[int, Exactness]:
    """The class of every node below `root`, by id."""
    found: dict[int, Exactness] = {}
    for shape in topological(root):
        found[shape.id] = _class(shape, found)
    return found


def is_no_distance(shape: Shape) -> bool:
    """Whether nothing is known of how far off the surface is where the field has some value: it may be flat."""
    return exactness(shape)[shape.id] is Exactness.NONE


def _class(shape: Shape, found: dict[int, Exactness]) -> Exactness:
    match shape:
        case Apply():
            return _applied(shape, [found[c.id] for c in shape.children])
        case Affine():
            kept = found[shape.child.id]
            return kept if kept is _N or is_similarity(shape.forward, shape.dimension) else _LB
        case Union():
            return _joined([found[c.id] for c in shape.children], (_E, _EO), _EO)
        case Intersection():
            return _joined([found[c.id] for c in shape.children], (_E, _EI), _EI)
        case Complement():
            kept = found[shape.child.id]
            return {_EO: _EI, _EI: _EO}.get(kept, kept)
        case Paint():
            return found[shape.child.id]
        case Nothing():
            return _E
        case _:
            assert_never(shape)


def _joined(classes: list[Exactness], good: tuple[Exactness, ...], result: Exactness) -> Exactness:
    if len(classes) == 1:
        return classes[0]
    if all(c in good for c in classes):
        return result
    return _N if _N in classes else _LB


def _applied(shape: Apply, children: list[Exactness]) -> Exactness:
    claimed = shape.definition.claims.exactness
    if not children or claimed in (_N, _LB):
        return _N if _N in children else claimed
    if _N in children:
        return _N
    if len(set(children)) == 1 and claimed is _E:
        return children[0]
    if claimed is _EO and all(c in (_E, _EO) for c in children):
        return _EO
    return _LB
