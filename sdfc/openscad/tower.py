"""A straight extrusion, its top scaled: every polygon and disc of a shape in the plane as a solid of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from sdfc.diagnostics import Span
from sdfc.openscad import outline, plane, space
from sdfc.openscad.context import Context
from sdfc.openscad.outline import Edge, Pocketed, Point2, Regular
from sdfc.openscad.plane import Common, Disc, Joined, Outside, Plane, Polygon, Stroke
from sdfc.openscad.polytope import Plane as Plane3
from sdfc.openscad.profile import profile
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Point
from sdfc.shape.graph import Shape

MOST_PLANES = 12  # sides of a regular polygon that become planes; with more of them one is folded onto the others
MOST_SIDES = 64  # of a convex polygon whose sides become planes; one with more is extruded as it is
MOST_PIECES = 40  # of a polygon that is taken apart into convex ones; one with more is extruded as it is
UNEVEN = "scaling x and y differently makes its sides curved"


@dataclass(frozen=True, slots=True)
class Reach:
    """From where to where a leaf goes, and its scales there."""

    low: float
    high: float
    low_scale: float
    high_scale: float


@dataclass(frozen=True, slots=True, eq=False)
class Tower:
    """From `low`, where the scale is 1, to `high`, where it is `x` and `y`."""

    context: Context
    span: Span
    low: float
    high: float
    x: float
    y: float

    @property
    def height(self) -> float:
        return self.high - self.low

    def solid(self, node: Plane, level: int, parts: list[Shape]) -> Shape:
        """For `plane.fold`. Below a complement a leaf goes on beyond the ends, so that no faces coincide there."""
        shapes = self.context.shapes
        match node:
            case Polygon():
                return self._polygon(node, level > 0)
            case Disc():
                return self._disc(node, self._reach(level > 0))
            case Stroke():
                return self._as_it_is(node, self._reach(level > 0))
            case Joined():
                return shapes.union(parts, self.span)
            case Common():
                return shapes.intersection(parts, self.span)
            case Outside():
                return shapes.complement(parts[0], self.span)
            case _:
                assert_never(node)

    def _reach(self, beyond: bool) -> Reach:
        """Longer by at most its height at each end, but not to where a scale is 0."""
        low, high = self.low, self.high
        if beyond:
            slopes = [(s - 1.0) / self.height for s in (self.x, self.y)]
            low -= min([self.height, *(0.5 / slope for slope in slopes if slope > 0.0)])
            ends = zip(slopes, (self.x, self.y), strict=True)
            high += min([self.height, *(-0.5 * s / slope for slope, s in ends if slope < 0.0)])
        return Reach(low, high, self._scales(low)[0], self._scales(high)[0])

    def _polygon(self, polygon: Polygon, beyond: bool) -> Shape:
        points = polygon.points
        ring = outline.regular_form(points) if len(points) > MOST_PLANES and self.x == self.y else None
        if ring is not None:
            return self._ring(ring, self._reach(beyond))
        if len(points) <= MOST_SIDES and outline.is_convex(points):
            return self._convex(points, outline.edges(points), beyond)
        tapers = (self.x, self.y) != (1.0, 1.0)
        if outline.is_simple(points) and len(points) <= 500:
            parts = outline.pocketed(points)
            if tapers or parts.pieces <= MOST_PIECES:
                hull = self._convex(outline.hull(points), parts.sides, beyond)
                pockets = [self._pocket(p) for p in parts.pockets]
                return self.context.shapes.difference(hull, pockets, self.span) if pockets else hull
        return self._as_it_is(polygon, self._reach(beyond))

    def _convex(self, points: Sequence[Point2], sides: Sequence[Edge], beyond: bool) -> Shape:
        reach = self._reach(beyond)
        corners: list[Point] = []
        for z in (reach.low, reach.high):
            a, b = self._scales(z)
            corners.extend((a * x, b * y, z) for x, y in points)
        return self.context.polytope(corners, [self._side(edge) for edge in sides], self.span)

    def _scales(self, z: float) -> tuple[float, float]:
        t = (z - self.low) / self.height
        return 1.0 + (self.x - 1.0) * t, 1.0 + (self.y - 1.0) * t

    def _side(self, edge: Edge) -> Plane3:
        """n . (x, y) <= d a(z) with the scale a(z): a plane, where the scales are one or the side is upright."""
        (a, b), d = edge
        scale = self.x
        if self.x != self.y:
            if min(abs(a), abs(b)) > 1e-9:
                raise RefusalError("this extrusion has no exact form", UNEVEN)
            scale = self.x if abs(a) > abs(b) else self.y
        slope = (scale - 1.0) / self.height
        c = -d * slope
        length = math.hypot(a, b, c)
        return (a / length, b / length, c / length), d * (1.0 - slope * self.low) / length

    def _pocket(self, pocket: Pocketed) -> Shape:
        outer = self.context.planes([self._side(edge) for edge in pocket.sides], self.span)
        inner = [self._pocket(p) for p in pocket.pockets]
        return self.context.shapes.difference(outer, inner, self.span) if inner else outer

    def _disc(self, disc: Disc, reach: Reach) -> Shape:
        """A cylinder or a cone, sheared where the disc is not around the origin."""
        if self.x != self.y:
            raise RefusalError("this extrusion has no exact form", UNEVEN)
        context, radius = self.context, disc.radius
        (a, b, x), (c, d, y) = disc.map
        if radius is not None:
            a, b, c, d = 1.0, 0.0, 0.0, 1.0
        size, height = radius or 1.0, context.number(reach.high - reach.low)
        if self.x == 1.0:
            shape = context.apply("cylinder", self.span, radius=context.number(size), height=height)
        else:
            bottom, top = context.number(size * reach.low_scale), context.number(size * reach.high_scale)
            shape = context.apply("capped_cone", self.span, bottom=bottom, top=top, height=height)
        upright = context.raised(shape, 0.5 * (reach.low + reach.high), self.span)
        return self._leaning(upright, (a, b, c, d), (x, y))

    def _ring(self, ring: Regular, reach: Reach) -> Shape:
        """A prism of many pieces, all alike."""
        context = self.context
        sizes = {
            "sides": float(ring.count),
            "bottom": ring.radius * reach.low_scale,
            "top": ring.radius * reach.high_scale,
            "height": reach.high - reach.low,
        }
        shape = context.apply("faceted_cone", self.span, **{name: context.number(v) for name, v in sizes.items()})
        upright = context.moved(space.translation((0.0, 0.0, 0.5 * (reach.low + reach.high))), shape, self.span)
        c, s = math.cos(ring.phase), math.sin(ring.phase)
        return self._leaning(upright, (c, -s, s, c), ring.center)

    def _leaning(self, upright: Shape, turn: tuple[float, float, float, float], center: Point2) -> Shape:
        """Turned in the plane, and moved to a centre that is scaled on the way up: a shear."""
        (a, b, c, d), (x, y) = turn, center
        slope = (self.x - 1.0) / self.height
        start = 1.0 - slope * self.low
        move = ((a, b, x * slope, x * start), (c, d, y * slope, y * start), (0.0, 0.0, 1.0, 0.0))
        return self.context.moved(move, upright, self.span)

    def _as_it_is(self, leaf: Polygon | Stroke, reach: Reach) -> Shape:
        """The distance in the plane, extruded: exact, but without a closed form for rays."""
        flat = profile(self.context, leaf, self.span)
        if (self.x, self.y) != (1.0, 1.0):
            return self._turned(flat, leaf, 0.0, reach)
        height = self.context.number(reach.high - reach.low)
        shape = self.context.apply("extrude", self.span, flat, height=height)
        middle = 0.5 * (reach.low + reach.high)
        return self.context.moved(space.translation((0.0, 0.0, middle)), shape, self.span)

    def twisted(self, root: Plane, twist: float) -> Shape:
        """Turned by `twist` (radians, clockwise) on the way up, as a smooth helix."""
        flat = profile(self.context, root, self.span)
        return self._turned(flat, root, twist, self._reach(beyond=False))

    def _turned(self, flat: Shape, root: Plane, twist: float, reach: Reach) -> Shape:
        """Turned and scaled on the way. The field's scale begins with 1 at the lowest point."""
        context, span = self.context, self.span
        if self.x != self.y:
            raise RefusalError("this extrusion has no exact form", UNEVEN)
        first = reach.low_scale
        numbers = {"height": reach.high - reach.low, "rate": twist / self.height}
        if self.x == 1.0:
            shape = context.apply("extrude_twisted", span, flat, **{n: context.number(v) for n, v in numbers.items()})
        else:
            numbers |= {"top": reach.high_scale / first, "reach": plane.farthest(root)}
            shape = context.apply("tapered_extrusion", span, flat, **{n: context.number(v) for n, v in numbers.items()})
        c, s = first * math.cos(0.5 * twist), first * math.sin(0.5 * twist)
        middle = 0.5 * (reach.low + reach.high)
        return context.moved(((c, s, 0.0, 0.0), (-s, c, 0.0, 0.0), (0.0, 0.0, 1.0, middle)), shape, span)
