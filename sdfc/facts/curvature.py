"""Which fields are convex functions: tangents of them never overshoot (ALGORITHMS B1, C5). Which solids are convex."""

from __future__ import annotations

from typing import assert_never

from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, topological


def convex_shapes(root: Shape) -> frozenset[int]:
    """The ids of the nodes below `root` whose formula is a convex function.

    A primitive that claims `convex` means its gauge; its formula is convex too where it is that gauge, or the exact
    distance of a convex set (T6).
    """
    convex: set[int] = set()
    for shape in topological(root):
        if _is_convex(shape, convex):
            convex.add(shape.id)
    return frozenset(convex)


def is_convex_solid(root: Shape) -> bool:
    """Whether the whole solid is known to be convex: no point of its surface hides the sky or a light from another."""
    convex = set(convex_shapes(root))
    for shape in topological(root):
        match shape:
            case Apply():  # of a gauge the solid is convex, though the formula need not be, nor what is made of it
                is_solid = shape.definition.is_primitive and shape.definition.claims.convex
            case _:
                is_solid = _is_convex(shape, convex)
        if is_solid:
            convex.add(shape.id)
    return root.id in convex


def _is_convex(shape: Shape, convex: set[int]) -> bool:
    match shape:
        case Apply():
            claims = shape.definition.claims
            if shape.definition.is_primitive:
                return claims.convex and (claims.gauge is None or claims.exactness is Exactness.EXACT)
            return claims.convex and all(c.id in convex for c in shape.children)
        case Affine() | Paint():
            return shape.child.id in convex
        case Intersection():
            return all(c.id in convex for c in shape.children)
        case Union():
            return len(shape.children) == 1 and shape.children[0].id in convex
        case Complement():
            return False
        case Nothing():
            return False
        case _:
            assert_never(shape)
