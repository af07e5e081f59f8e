"""A shape in the plane turned around an axis (`rotate_extrude`): round, or in flat pieces, fully or by an angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from sdfc.diagnostics import Span
from sdfc.openscad import outline, plane
from sdfc.openscad.context import Context
from sdfc.openscad.outline import Edge, Pocketed, Point2
from sdfc.openscad.plane import Common, Disc, Joined, Outside, Plane, Polygon, Stroke
from sdfc.openscad.polytope import Plane as Plane3
from sdfc.openscad.profile import profile
from sdfc.openscad.refusal import RefusalError
from sdfc.shape.graph import Shape


@dataclass(frozen=True, slots=True, eq=False)
class Lathe:
    """Turns what has x >= 0 by `angle` (radians; 2 pi is all around). `is_mirrored`: it was on the other side."""

    context: Context
    span: Span
    angle: float
    is_mirrored: bool
    facets: int | None

    @property
    def is_full(self) -> bool:
        return abs(self.angle) >= math.tau

    @property
    def start(self) -> float:
        """Where OpenSCAD begins."""
        return math.pi if self.is_full is not self.is_mirrored else 0.0

    @property
    def pieces(self) -> int:
        """How many flat pieces there are."""
        return max(1, int((self.facets or 0) * abs(self.angle) / math.tau + 1e-9))

    def turned(self, root: Plane) -> Shape | None:
        """The solid; None where nothing has x > 0."""
        shape = plane.fold(root, self._solid)
        if shape is None or self.is_full:
            return shape
        first, last = sorted((self.start, self.start + self.angle))
        sides = [
            self._half_space((math.sin(first), -math.cos(first))),
            self._half_space((-math.sin(last), math.cos(last))),
        ]
        shapes = self.context.shapes
        if last - first > math.pi:
            return shapes.intersection((shape, shapes.union(sides, self.span)), self.span)
        return shapes.intersection((shape, *sides), self.span)

    def _half_space(self, normal: Point2) -> Shape:
        return self.context.planes([((*normal, 0.0), 0.0)], self.span)

    def _solid(self, node: Plane, _: int, parts: list[Shape | None]) -> Shape | None:
        shapes = self.context.shapes
        match node:
            case Polygon():
                return self._polygon(node)
            case Disc() | Stroke():
                return self._curved(node)
            case Joined():
                kept = [p for p in parts if p is not None]
                return shapes.union(kept, self.span) if kept else None
            case Common():
                gone = [c for c, p in zip(node.children, parts, strict=True) if p is None]
                if not all(isinstance(c, Outside) for c in gone):
                    return None
                return shapes.intersection([p for p in parts if p is not None], self.span)
            case Outside():
                return None if parts[0] is None else shapes.complement(parts[0], self.span)
            case _:
                assert_never(node)

    def _polygon(self, polygon: Polygon) -> Shape | None:
        points = polygon.points
        lo, hi = min(points)[0], max(points)[0]
        if hi <= 0.0:
            return None
        if self.facets is not None:
            return self._faceted(points)
        low, high = min(p[1] for p in points), max(p[1] for p in points)
        if len(points) == 4 and all(x in (lo, hi) and y in (low, high) for x, y in points):
            return self._tube(max(lo, 0.0), hi, low, high)
        return self._revolved(polygon)

    def _tube(self, inner: float, outer: float, low: float, high: float) -> Shape:
        context = self.context
        height, middle = context.number(high - low), 0.5 * (low + high)
        if inner <= 1e-9 * outer:
            shape = context.apply("cylinder", self.span, radius=context.number(outer), height=height)
        else:
            radii = {"outer": context.number(outer), "inner": context.number(inner)}
            shape = context.apply("tube", self.span, **radii, height=height)
        return context.raised(shape, middle, self.span)

    def _curved(self, leaf: Disc | Stroke) -> Shape | None:
        if self.facets is not None:
            raise RefusalError(
                "a true curve in a `rotate_extrude` of few pieces has no exact form", "give both the same $fn"
            )
        box = plane.extent(leaf)
        if box is not None and box[1][0] <= 0.0:
            return None
        radius = leaf.radius if isinstance(leaf, Disc) else None
        if isinstance(leaf, Disc) and radius is not None:
            x, z = leaf.center
            context = self.context
            if abs(x) <= 1e-9 * radius:
                ball = context.apply("sphere", self.span, radius=context.number(radius))
                return context.raised(ball, z, self.span)
            if x > radius:
                radii = {"major": context.number(x), "minor": context.number(radius)}
                return context.raised(context.apply("torus", self.span, **radii), z, self.span)
        return self._revolved(leaf)

    def _revolved(self, leaf: Polygon | Disc | Stroke) -> Shape:
        flat = profile(self.context, leaf, self.span)
        return self.context.raised(self.context.apply("revolve", self.span, flat), 0.0, self.span)

    def _faceted(self, points: Sequence[Point2]) -> Shape:
        """In flat pieces, {(largest of the pieces' distances from the axis, z) in the polygon}: sides become planes."""
        if not outline.is_simple(points) or len(points) > 500:
            raise RefusalError("a polygon that crosses itself cannot be turned in flat pieces")
        parts = outline.pocketed(points)
        around = [self.start + self.angle * i / self.pieces for i in range(self.pieces + 1)]
        corners = [(x * math.cos(a), x * math.sin(a), z) for x, z in outline.hull(points) for a in around]
        corners += [(0.0, 0.0, z) for _, z in points]
        outer, inner = self._walls(parts)
        hull = self.context.polytope(corners, outer, self.span)
        taken = [*inner, *(self._pocket(p) for p in parts.pockets)]
        return self.context.shapes.difference(hull, taken, self.span) if taken else hull

    def _pocket(self, pocket: Pocketed) -> Shape:
        outer, inner = self._walls(pocket)
        shapes = self.context.shapes
        kept = [self.context.planes(outer, self.span)] if outer else []
        taken = [*inner, *(self._pocket(p) for p in pocket.pockets)]
        return shapes.intersection([*kept, *(shapes.complement(t, self.span) for t in taken)], self.span)

    def _walls(self, region: Pocketed) -> tuple[list[Plane3], list[Shape]]:
        """The planes that the sides facing away from the axis become; and for each other side what it keeps out."""
        outer: list[Plane3] = []
        inner: list[Shape] = []
        for (across, up), offset in region.sides:
            if abs(across) < 1e-12:
                outer.append(((0.0, 0.0, math.copysign(1.0, up)), offset))
            elif across > 0.0:
                outer.extend(self._ring(((across, up), offset)))
            else:
                inner.append(self.context.planes(self._ring(((-across, -up), -offset)), self.span))
        return outer, inner

    def _ring(self, side: Edge) -> list[Plane3]:
        """One plane for each piece. A piece's distance from the axis is that of its middle over cos(half its angle)."""
        (across, up), offset = side
        step = self.angle / self.pieces
        across /= math.cos(0.5 * step) if self.pieces > 1 or abs(step) < math.pi else 1.0
        length = math.hypot(across, up)
        across, up, offset = across / length, up / length, offset / length
        middles = [self.start + step * (i + 0.5) for i in range(self.pieces)]
        return [((across * math.cos(a), across * math.sin(a), up), offset) for a in middles]
