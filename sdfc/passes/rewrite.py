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
    made: dict[tuple[Shape, Given], Shape] = {}
    opened: dict[tuple[Shape, Given], Sequence[tuple[Shape, Given]]] = {}
    stack = [(root, given)]
    while stack:
        asking = stack.pop()
        if asking in made:
            continue
        asked = opened.pop(asking, None)
        if asked is None:
            asked = below(*asking)
            missing = [one for one in asked if one not in made]
            if missing:
                opened[asking] = asked
                stack.append(asking)
                missing.reverse()
                stack += missing
                continue
        made[asking] = make(*asking, tuple([made[one] for one in asked]))
    return made[root, given]
