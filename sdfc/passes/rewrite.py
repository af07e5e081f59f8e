"""Walking a shape graph from above, with something handed down: a map, a material, a sign."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

from sdfc.shape.graph import Shape

Given = TypeVar("Given", bound=Hashable)


def descend(
    root: Shape,
    given: Given,
    below: Callable[[Shape, Given], Sequence[tuple[Shape, Given]]],
    make: Callable[[Shape, Given, tuple[Shape, ...]], Shape],
) -> Shape:
    """The root, rewritten: `below` says what a node with what it was given asks for, `make` makes its successor from
    the answers. A node is made once for everything that it is given. Iterative: depth is no limit."""
    made: dict[tuple[int, Given], Shape] = {}
    opened: dict[tuple[int, Given], Sequence[tuple[Shape, Given]]] = {}
    stack = [(root, given)]
    while stack:
        shape, own = stack[-1]
        key = (shape.id, own)
        if key in made:
            stack.pop()
        elif key in opened:
            answers = tuple([made[child.id, handed] for child, handed in opened.pop(key)])
            made[key] = make(shape, own, answers)
            stack.pop()
        else:
            opened[key] = below(shape, own)
            stack.extend(reversed(opened[key]))
    return made[root.id, given]
