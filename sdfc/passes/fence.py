"""What operations ask of their children's boxes is told them, where their values far away matter (ALGORITHMS C3)."""

from __future__ import annotations

from sdfc.facts.bounds import Bounds, child_facts
from sdfc.passes.rewrite import descend
from sdfc.shape.graph import Apply, Shape, ShapeGraph, definitions_of


def fence(root: Shape, graph: ShapeGraph, bounds: Bounds) -> Shape:
    """Afterwards each parameter that is found, of an operation that stands in another, has a value from the boxes of
    its children, where none of these is empty. Then the operation's field grows however far away, so that what is made
    of it by rounding, hollowing or blending has an end where its child has one. The operation itself is the same solid;
    one that stands alone is looked at only where it is, and is left as it is."""

    if not any(definition.asks_for_boxes for definition in definitions_of(root)):
        return root

    def below(shape: Shape, is_operand: bool) -> list[tuple[Shape, bool]]:
        return [(child, is_operand or isinstance(shape, Apply)) for child in shape.children]

    def make(shape: Shape, is_operand: bool, children: tuple[Shape, ...]) -> Shape:
        kept = graph.with_children(shape, children)
        return _found(kept, graph, bounds) if is_operand and isinstance(kept, Apply) else kept

    return descend(root, False, below, make)


def _found(shape: Apply, graph: ShapeGraph, bounds: Bounds) -> Shape:
    """The same with what can be found of its children."""
    if not shape.definition.asks_for_boxes:
        return shape
    boxes = [bounds.box(child) for child in shape.children]
    if any(box.is_empty for box in boxes):
        return shape
    facts = child_facts(bounds.values, shape, boxes)
    pairs = zip(shape.definition.values, shape.arguments, strict=True)
    arguments = [a if p.found is None else p.found(shape.environment, facts) for p, a in pairs]
    return graph.apply(shape.definition, arguments, shape.children, shape.span)
