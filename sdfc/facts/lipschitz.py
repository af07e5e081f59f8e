"""How fast a field may change: claimed, or bounded by intervals of its gradient (ALGORITHMS C3)."""

from __future__ import annotations

import math
from typing import assert_never

from sdfc.diagnostics import scene_error
from sdfc.facts.bounds import Bounds, _graph_of, child_facts
from sdfc.facts.box import Box
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Type
from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, children_of, topological
from sdfc.shape.lower import lower
from sdfc.shape.stretch import largest_stretch, smallest_stretch


class Lipschitz:
    """Constants by shape, each over a box in the shape's own space (the box where the shape can matter)."""

    def __init__(self, ranges: Ranges, bounds: Bounds) -> None:
        self._ranges = ranges
        self._bounds = bounds
        self._made: dict[tuple[int, Box], float] = {}

    def constant(self, shape: Shape, domain: Box) -> float:
        key = (shape.id, domain)
        if key not in self._made:
            self._made[key] = self._constant(shape, domain)
        return self._made[key]

    def is_global(self, shape: Shape) -> bool:
        """Whether every constant below was claimed: then it holds everywhere, not only in a box."""
        return all(self._is_claimed(node) for node in topological(shape))

    def _is_claimed(self, shape: Shape) -> bool:
        match shape:
            case Apply():
                claims = shape.definition.claims
                return claims.lipschitz is not None or claims.exactness is not Exactness.NONE
            case _:
                return True

    def _constant(self, shape: Shape, domain: Box) -> float:
        match shape:
            case Apply():
                return self._apply(shape, domain)
            case Affine():
                inner = domain
                if shape.inverse.is_constant:
                    rows = [[e.number for e in row] for row in shape.inverse.linear]
                    inner = domain.moved(rows, [e.number for e in shape.inverse.offset])
                ratio = self._ranges.interval(smallest_stretch(shape.forward, shape.dimension) * largest_stretch(shape.inverse, shape.dimension))[1]
                ratio = 1.0 if abs(ratio - 1.0) < 1e-6 else ratio
                return self.constant(shape.child, inner) * ratio
            case Union() | Intersection() | Complement() | Paint():
                return max(self.constant(c, domain) for c in children_of(shape))
            case Nothing():
                return 0.0
            case _:
                assert_never(shape)

    def _apply(self, shape: Apply, domain: Box) -> float:
        claims = shape.definition.claims
        graph = _graph_of(shape)
        if claims.lipschitz is not None:
            boxes = [self._bounds.box(c) for c in shape.children]
            # a child's own space is not the parent's: its constant is asked for over its own box
            slopes = [self.constant(c, b) for c, b in zip(shape.children, boxes, strict=True)]
            value = claims.lipschitz(shape.environment, child_facts(graph, shape, boxes, slopes))
            claimed = self._ranges.interval(value)[1]
            if not math.isnan(claimed) and claimed < math.inf:
                return claimed
        elif claims.exactness is not Exactness.NONE and shape.definition.is_primitive:
            return 1.0
        elif claims.exactness is not Exactness.NONE:
            return max(self.constant(c, self._bounds.box(c)) for c in shape.children)
        return self._by_intervals(shape, domain)

    def _by_intervals(self, shape: Apply, domain: Box) -> float:
        from sdfc.field.interval import gradient_bound

        own = self._bounds.box(shape).meet(domain)
        graph = _graph_of(shape)
        p = graph.input("p", Type.VEC3 if shape.dimension == 3 else Type.VEC2)
        bound = gradient_bound(lower(shape, p), own.lo, own.hi, self._ranges.of) if not own.is_empty else 1.0
        if not math.isfinite(bound):
            raise scene_error(
                f"no bound of the slope of '{shape.definition.name}' could be found"
                + (" over its box" if own.is_finite else ": it has no bounds"),
                shape.span,
                "claim one (`lipschitz 2`), or keep it in a box: `& box(size: [2, 2, 2])`",
            )
        return bound
