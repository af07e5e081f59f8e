"""Materials go to the leaves."""

from __future__ import annotations

from typing import assert_never

from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union
from sdfc.shape.material import Material


def paint(root: Shape, graph: ShapeGraph) -> Shape:
    """Afterwards every Paint has a primitive as its child, and paints it for certain.

    The nearest material wins: a part keeps its own where the whole is painted later. What cuts a part, and has no
    material of its own, shows the part's first one on the cut.
    """
    return _Painter(graph).painted(root, None)


class _Painter:
    def __init__(self, graph: ShapeGraph) -> None:
        self._graph = graph
        self._made: dict[tuple[int, int], Shape] = {}
        self._first: dict[int, Material | None] = {}

    def painted(self, shape: Shape, material: Material | None) -> Shape:
        key = (shape.id, id(material))
        if key not in self._made:
            self._made[key] = self._paint(shape, material)
        return self._made[key]

    def _paint(self, shape: Shape, material: Material | None) -> Shape:
        match shape:
            case Paint():
                return self.painted(shape.child, shape.material)
            case Apply() if shape.definition.is_primitive:
                return shape if material is None else self._graph.paint(material, shape, shape.span)
            case Intersection():
                cut = self._first_material(shape.children[0]) or material
                rest = [self.painted(c, cut) for c in shape.children[1:]]
                return self._graph.with_children(shape, (self.painted(shape.children[0], material), *rest))
            case Union() | Apply():
                children = [self.painted(c, material) for c in shape.children]
                return self._graph.with_children(shape, tuple(children))
            case Affine() | Complement():
                return self._graph.with_children(shape, (self.painted(shape.child, material),))
            case Nothing():
                return shape
            case _:
                assert_never(shape)

    def _first_material(self, shape: Shape) -> Material | None:
        """The material of the first painted part."""
        if shape.id not in self._first:
            self._first[shape.id] = self._find(shape)
        return self._first[shape.id]

    def _find(self, shape: Shape) -> Material | None:
        match shape:
            case Paint():
                return shape.material
            case Affine() | Complement():
                return self._first_material(shape.child)
            case Apply() | Union() | Intersection():
                for child in shape.children:
                    found = self._first_material(child)
                    if found is not None:
                        return found
                return None
            case Nothing():
                return None
            case _:
                assert_never(shape)
