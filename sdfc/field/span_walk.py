"""What is known of each node of an expression along a piece of a ray, and of what is affine or convex by its form."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sdfc.field.derivative import tangents
from sdfc.field.graph import Expr, Op, Type, topological
from sdfc.field.span_ranges import Range, Ranges, point

SLACK = 2.0**-21


class Bend(Enum):
    """What is known of a track's second derivative by its form."""

    AFFINE = 0
    CONVEX = 1
    CONCAVE = -1
    UNKNOWN = 2

    @property
    def mirrored(self) -> Bend:
        """The bend of the negative."""
        return {Bend.CONVEX: Bend.CONCAVE, Bend.CONCAVE: Bend.CONVEX}.get(self, self)

    def plus(self, other: Bend) -> Bend:
        """The bend of a sum."""
        if self is other or other is Bend.AFFINE:
            return self
        return other if self is Bend.AFFINE else Bend.UNKNOWN


@dataclass(frozen=True, slots=True)
class Track:
    """A FLOAT, or a component of a vector, over the piece of the ray; a BOOL has its two truths as its value.

    `here` and `rise` are its value and derivative at the start. `slope` is None where it does not move.
    """

    value: Range
    slope: Range | None
    here: Expr
    rise: Expr | None = None
    bend: Bend = Bend.UNKNOWN
    is_positive: bool = False  # by its form: never below 0

    @property
    def moves(self) -> bool:
        return self.slope is not None


class Walk:
    """The piece of the ray, p + tau d for 0 <= tau <= s, and what `root` and all below it do at its two ends."""

    def __init__(self, root: Expr, p: Expr, d: Expr, s: Expr) -> None:
        graph = root.graph
        size = [graph.abs(p[i]) + s * graph.abs(d[i]) for i in range(p.type.size)]
        self.ranges = Ranges(graph, SLACK * sum(size[1:], size[0]))
        self.graph = graph
        self._s = s
        self._tangents = tangents(root, {p: d})
        self._ahead: dict[int, Expr] = {p.id: p + s * d}

    def parts(self, node: Expr) -> list[tuple[Expr, Expr]]:
        """Value and derivative at the start, for each component of a node."""
        tangent = self._tangents.get(node.id)
        if node.type.size == 1:
            return [(node, self.graph.constant(0.0) if tangent is None else tangent)]
        rises = [self.graph.constant(0.0) if tangent is None else tangent[i] for i in range(node.type.size)]
        return [(node[i], rise) for i, rise in enumerate(rises)]

    def affine(self, here: Expr, rise: Expr) -> Track:
        """A track with one derivative."""
        if rise.is_constant and rise.number == 0.0:
            return self._unmoved(here)
        ahead = here + self._s * rise
        value = Range(self.graph.min(here, ahead), self.graph.max(here, ahead))
        return Track(value, point(rise), here, rise, Bend.AFFINE)

    def curved(self, here: Expr, rise: Expr, bend: Bend, is_positive: bool = False) -> Track:
        """A track that is convex or concave: its tangents at both ends bound it, its ends bound the other side."""
        g, s = self.graph, self._s
        if bend is Bend.AFFINE:
            return self.affine(here, rise)
        ahead, rise_ahead = self._there(here), self._there(rise)
        if bend is Bend.CONVEX:
            low = g.max(here + s * g.min(rise, 0.0), ahead - s * g.max(rise_ahead, 0.0))
            value = Range(g.max(low, 0.0) if is_positive else low, g.max(here, ahead))
            return Track(value, Range(rise, rise_ahead), here, rise, bend, is_positive)
        high = g.min(here + s * g.max(rise, 0.0), ahead - s * g.min(rise_ahead, 0.0))
        return Track(Range(g.min(here, ahead), high), Range(rise_ahead, rise), here, rise, bend)

    def moving(self, track: Track) -> Range:
        """The slope, also of what does not move."""
        return point(self.graph.constant(0.0)) if track.slope is None else track.slope

    def difference(self, a: Track, b: Track) -> Range:
        """The range of a - b: exact where both are affine."""
        if a.bend is Bend.AFFINE and b.bend is Bend.AFFINE and (a.moves or b.moves):
            rise = (a.rise or self.graph.constant(0.0)) - (b.rise or self.graph.constant(0.0))
            return self.affine(a.here - b.here, rise).value
        return self.ranges.subtracted(a.value, b.value)

    def _there(self, node: Expr) -> Expr:
        """The node at the end of the piece."""
        for each in topological([node], lambda n: () if n.id in self._ahead else n.args):
            if each.id not in self._ahead:
                args = tuple(self._ahead[a.id] for a in each.args)
                same = all(a is b for a, b in zip(args, each.args, strict=True))
                self._ahead[each.id] = each if same else self.graph.add(each.op, *args, value=each.value)
        return self._ahead[node.id]

    def still(self, node: Expr) -> tuple[Track, ...]:
        if node.type.size == 1:
            return (self._unmoved(node),)
        return tuple(self._unmoved(node[i]) for i in range(node.type.size))

    def _unmoved(self, here: Expr) -> Track:
        positive = here.is_constant and here.type is Type.FLOAT and here.number >= 0.0
        positive = positive or here.op in (Op.ABS, Op.LENGTH, Op.EXP)
        return Track(point(here), None, here, None, Bend.AFFINE, positive)
