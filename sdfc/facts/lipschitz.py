"""How fast a field may change: claimed, or bounded by intervals of its gradient (ALGORITHMS C3)."""

from __future__ import annotations

import itertools
import math
from types import MappingProxyType
from typing import assert_never

from sdfc.diagnostics import SceneError, scene_error
from sdfc.facts.bounds import Bounds, child_facts
from sdfc.facts.box import Box, everything
from sdfc.facts.pointwise import is_pointwise
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Expr, Op, Type, params_of
from sdfc.field.graph import topological as topological_values
from sdfc.shape.definition import Exactness
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
from sdfc.shape.lower import lower

_MOST_SUSPECTS = 2000  # nodes of a formula that are looked at for what makes it steep
_STEEP = MappingProxyType(
    {
        Op.FLOOR: "`floor` jumps",
        Op.ROUND: "`round` jumps",
        Op.SIGN: "`sign` jumps",
        Op.MOD: "`mod` jumps",
        Op.SELECT: "`if` may jump from one value to the other",
        Op.SQRT: "`sqrt` is steep without limit at 0",
        Op.POW: "`pow` may be steep without limit at 0",
        Op.LOG: "`log` is steep without limit at 0",
        Op.DIV: "a division by what may be 0",
        Op.TAN: "`tan` has poles",
        Op.ASIN: "`asin` is steep without limit at -1 and 1",
        Op.ACOS: "`acos` is steep without limit at -1 and 1",
        Op.ATAN2: "`atan` of two numbers jumps where the first changes its sign",
    }
)


class Lipschitz:
    """Constants by shape: everywhere where all below have claimed one, else over a box in the shape's own space."""

    def __init__(self, ranges: Ranges, bounds: Bounds) -> None:
        self._ranges = ranges
        self._bounds = bounds
        self._everywhere: dict[int, float | None] = {}
        self._inside: dict[tuple[int, Box], float] = {}

    def constant(self, shape: Shape, domain: Box) -> float:
        """Over what of the domain the shape's box holds: the segment to the nearest surface lies in both.

        Raises SceneError where a formula claims nothing, and no bound of its slope can be found.
        """
        everywhere = self._global(shape)
        return self._over(shape, self._bounds.box(shape).meet(domain)) if everywhere is None else everywhere

    def throughout(self, shape: Shape, domain: Box) -> float:
        """Over all of the domain, also far from the shape: for what is blended with others. Raises like `constant`."""
        return self._over(shape, domain)

    def is_global(self, shape: Shape) -> bool:
        """Whether every constant below was claimed: then it holds everywhere, not only in a box."""
        return self._global(shape) is not None

    # --- everywhere

    def _global(self, shape: Shape) -> float | None:
        if shape.id not in self._everywhere:
            for node in topological(shape):
                if node.id not in self._everywhere:
                    self._everywhere[node.id] = self._claimed_by_all(node)
        return self._everywhere[shape.id]

    def _claimed_by_all(self, node: Shape) -> float | None:
        below = [self._everywhere[c.id] for c in node.children]
        slopes = [slope for slope in below if slope is not None]
        if len(slopes) < len(below):
            return None
        match node:
            case Apply():
                return self._claimed(node, slopes)
            case Affine() | Union() | Intersection() | Complement() | Paint():
                return max(slopes)  # an affine map's field is divided by the most that the map steepens it
            case Nothing():
                return 1.0  # any will do; one can be divided by
            case _:
                assert_never(node)

    def _claimed(self, node: Apply, slopes: list[float]) -> float | None:
        """The constant that the node claims over children of these; None where it claims none that is finite."""
        claims = node.definition.claims
        if claims.lipschitz is None:
            return None if claims.exactness is Exactness.NONE else max(slopes, default=1.0)
        claim = claims.lipschitz

        def most(boxes: list[Box]) -> float:
            facts = child_facts(self._bounds.values, node, boxes, slopes)
            return self._ranges.interval(claim(node.environment, facts))[1]

        value = most([everything(c.dimension) for c in node.children])
        if not math.isfinite(value) and node.children:  # it depends on how large they are
            value = most([self._bounds.box(c) for c in node.children])
        return value if math.isfinite(value) else None

    # --- in a box

    def _over(self, shape: Shape, region: Box) -> float:
        everywhere = self._global(shape)
        if everywhere is not None:
            return everywhere
        key = (shape.id, region)
        if key not in self._inside:
            self._inside[key] = self._found(shape, region)
        return self._inside[key]

    def _found(self, shape: Shape, region: Box) -> float:
        match shape:
            case Apply():
                # where the children are looked at is only known if that is the point itself
                if shape.children and is_pointwise(shape, self._bounds.values):
                    claimed = self._claimed(shape, [self._over(c, region) for c in shape.children])
                    if claimed is not None:
                        return claimed
                return self._by_intervals(shape, region)
            case Affine():
                return self._over(shape.child, self._bounds.moved(shape.inverse, region))
            case Union() | Intersection() | Complement() | Paint():
                return max([self._over(c, region) for c in shape.children])
            case Nothing():
                return 1.0  # any will do; one can be divided by
            case _:
                assert_never(shape)

    def _by_intervals(self, shape: Apply, region: Box) -> float:
        from sdfc.field.steepness import gradient_bound

        if region.is_empty:
            return 1.0
        p = self._bounds.values.input("p", Type(shape.dimension))
        value = lower(shape, p)
        # where a param stands twice, its whole range counts twice: pieces of the range lose less
        pieces = self._ranges.pieces(params_of([value]))
        bound = gradient_bound(value, region.lo, region.hi, pieces)
        if not math.isfinite(bound):
            raise self._unbounded(shape, region, value)
        return bound

    def _unbounded(self, shape: Apply, region: Box, value: Expr) -> SceneError:
        """Names what is to blame: the first function of the formula, from within, whose slope has no bound."""
        from sdfc.field.steepness import gradient_bound

        what = f"no bound of the slope of '{shape.definition.name}' could be found"
        claims = shape.definition.claims
        if not region.is_finite and claims.bounds is not None and not claims.bounds_use_level:
            hint = "claim one (`lipschitz 2`), or bounds that use `level`: where its value is at most that"
            return scene_error(
                f"{what}: its bounds say nothing of where it is above zero, which counts here", shape.span, hint
            )
        if not region.is_finite:
            hint = "claim one (`lipschitz 2`), or keep it in a box: `& box(size: [2, 2, 2])`"
            return scene_error(f"{what}: it has no bounds", shape.span, hint)
        for node in itertools.islice(topological_values([value]), _MOST_SUSPECTS):
            if node.op in _STEEP and not math.isfinite(
                gradient_bound(node, region.lo, region.hi, [self._ranges.of], 64)
            ):
                return scene_error(f"{what} over its box: {_STEEP[node.op]}", shape.span, "claim one: `lipschitz 2`")
        return scene_error(f"{what} over its box", shape.span, "claim one: `lipschitz 2`")
