"""Materials go to the leaves."""

from __future__ import annotations

from typing import assert_never

from sdfc.passes.rewrite import descend
from sdfc.shape.graph import (
    Affine,
    Apply,
    Complement,
    Intersection,
    Nothing,
    Paint,
    Shape,
    ShapeGraph,
    Union,
    topological,
)
from sdfc.shape.material import Material


def paint(root: Shape, graph: ShapeGraph) -> Shape:
    """Afterwards every Paint has a primitive as its child, and paints it for certain.

    The nearest material wins: a part keeps its own where the whole is painted later. What cuts a part, and has no
    material of its own, shows the part's first one on the cut.
    """
    first = _first_materials(root)

    def below(shape: Shape, material: Material | None) -> list[tuple[Shape, Material | None]]:
        match shape:
            case Paint():
                return [(shape.child, shape.material)]
            case Intersection():
                cut = first[shape.children[0].id] or material
                return [(shape.children[0], material), *((c, cut) for c in shape.children[1:])]
            case Apply() | Union() | Affine() | Complement() | Nothing():
                return [(c, material) for c in shape.children]
            case _:
                assert_never(shape)

    def make(shape: Shape, material: Material | None, children: tuple[Shape, ...]) -> Shape:
        match shape:
            case Paint():
                return children[0]
            case Apply() if shape.definition.is_primitive:
                return shape if material is None else graph.paint(material, shape, shape.span)
            case _:
                return graph.with_children(shape, children)

    return descend(root, None, below, make)


def _first_materials(root: Shape) -> dict[int, Material | None]:
    """By node: the material of its first painted part."""
    first: dict[int, Material | None] = {}
    for shape in topological(root):
        match shape:
            case Paint():
                first[shape.id] = shape.material
            case _:
                found = (first[c.id] for c in shape.children)
                first[shape.id] = next((m for m in found if m is not None), None)
    return first
