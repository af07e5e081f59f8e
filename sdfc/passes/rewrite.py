"""Walking a shape graph bottom-up."""

from __future__ import annotations

from collections.abc import Callable

from sdfc.shape.graph import Shape, ShapeGraph, children_of, topological


def rewrite(root: Shape, graph: ShapeGraph, change: Callable[[Shape], Shape]) -> Shape:
    """`change` at every node, children first; each node is offered once, with its children already changed."""
    made: dict[int, Shape] = {}
    for shape in topological(root):
        children = tuple(made[c.id] for c in children_of(shape))
        made[shape.id] = change(graph.with_children(shape, children))
    return made[root.id]
