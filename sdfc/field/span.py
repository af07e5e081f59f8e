"""What a field does along a piece of a ray, as field expressions: bounds of its value and of its derivative.

For f, a point q, a direction d and a length s >= 0: bounds of f(q + tau d) and of its derivative in tau over
0 <= tau <= s, after Galin et al. 2020 and Aydinlilar & Zanni 2023 (interval values and derivatives by forward mode).
The twin of `IntervalEvaluator.along_ray`, to be printed as GLSL or evaluated in float64.

Vectors are taken apart. What is affine in tau has one derivative and its ends for bounds, and what is convex by its
form (|affine|, the length of an affine vector, maxima and sums of these) has the derivatives at both ends for bounds:
both exact, with no arithmetic of ranges at all. Only the rest goes operation by operation (`span_rules`).

Rounding. At the end the slopes are widened by UNIT of themselves and of |d|, the values by UNIT of themselves and of
the coordinates; decisions on the way have slack, see `span_ranges`.
Read with the value: f(q + tau d) lies between f(q) + lo tau and f(q) + hi tau up to what rounding does to f itself.
"""

from __future__ import annotations

from dataclasses import dataclass

from sdfc.field.graph import Expr, FieldGraph, topological
from sdfc.field.span_ranges import HUGE, Range, point
from sdfc.field.span_rules import RULES
from sdfc.field.span_walk import Bend, Track, Walk

UNIT = 2.0**-20


@dataclass(frozen=True, slots=True)
class Span:
    """Bounds of a field and of its derivative in tau; `slope` is within +-HUGE, which stands for "may jump"."""

    value: Range
    slope: Range

    @property
    def vector(self) -> Expr:
        """VEC4: value lo, value hi, slope lo, slope hi."""
        return self.value.lo.graph.vector(*self.value, *self.slope)


def span(root: Expr, p: Expr, d: Expr, s: Expr) -> Span:
    """Bounds of `root` (a FLOAT in the INPUT `p`) along p + tau d for 0 <= tau <= s."""
    graph = root.graph
    walk = Walk(root, p, d, s)
    track = _track(root, p, walk)
    value = track.value
    if track.slope is None:
        return Span(value, point(graph.constant(0.0)))
    slope = _settled(graph, track.slope, d)
    if track.bend is Bend.UNKNOWN:  # the mean value theorem
        lo = graph.max(value.lo, root + s * graph.min(slope.lo, 0.0))
        hi = graph.min(value.hi, root + s * graph.max(slope.hi, 0.0))
        value = Range(lo, hi)
    margin = walk.ranges.slack + UNIT * graph.max(-value.lo, value.hi)
    return Span(Range(value.lo - margin, value.hi + margin), slope)


def _settled(graph: FieldGraph, slope: Range, d: Expr) -> Range:
    """Widened for rounding, and finite: what is not a number is unbounded."""
    most = graph.abs(d[0])
    for i in range(1, d.type.size):
        most = most + graph.abs(d[i])
    margin = UNIT * (graph.max(-slope.lo, slope.hi) + most)
    lo, hi = slope.lo - margin, slope.hi + margin
    least = graph.constant(-HUGE)
    return Range(graph.select(least < lo, lo, least), graph.select(hi < HUGE, hi, HUGE))


def _track(root: Expr, p: Expr, walk: Walk) -> Track:
    tracks: dict[int, tuple[Track, ...]] = {}
    for node in topological([root]):
        arguments = [tracks[a.id] for a in node.args]
        if node is p:
            tracks[node.id] = tuple(walk.affine(here, rise) for here, rise in walk.parts(node))
        elif any(t.moves for argument in arguments for t in argument):
            tracks[node.id] = RULES[node.op](walk, node, arguments)
        else:
            tracks[node.id] = walk.still(node)
    (track,) = tracks[root.id]
    return track
