"""How each operation of the field graph treats tracks: `interval_rules` and `interval_slopes`, written down.

Slopes are Clarke's: at a kink both sides count. Where an operation may jump the slope is everything.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import TypeAlias

from sdfc.field import span_functions as functions
from sdfc.field.graph import Expr, Op
from sdfc.field.span_functions import Component
from sdfc.field.span_ranges import Range, point
from sdfc.field.span_walk import Bend, Track, Walk

Tracks: TypeAlias = tuple[Track, ...]
Rule: TypeAlias = Callable[[Walk, Expr, Sequence[Tracks]], Tracks]


def by_component(rule: Component) -> Rule:
    """A rule for an operation that works component by component."""

    def apply(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
        tracks = []
        for i, (here, rise) in enumerate(walk.parts(node)):
            taken = [a[i] if len(a) > 1 else a[0] for a in arguments]
            if any(t.moves for t in taken):
                tracks.append(rule(walk, here, rise, taken))
            else:
                tracks.append(Track(point(here), None, here, None, Bend.AFFINE))
        return tuple(tracks)

    return apply


# ---- sums and products


def _add(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    a, b = args
    bend, positive = a.bend.plus(b.bend), a.is_positive and b.is_positive
    if bend is not Bend.UNKNOWN:
        return walk.curved(here, rise, bend, positive)
    slope = walk.ranges.added(walk.moving(a), walk.moving(b))
    return Track(walk.ranges.added(a.value, b.value), slope, here, rise, bend, positive)


def _negate(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    (a,) = args
    ranges = walk.ranges
    return Track(ranges.negated(a.value), ranges.negated(walk.moving(a)), here, rise, a.bend.mirrored)


def _subtract(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    a, b = args
    bend = a.bend.plus(b.bend.mirrored)
    if bend is not Bend.UNKNOWN:
        return walk.curved(here, rise, bend)
    slope = walk.ranges.subtracted(walk.moving(a), walk.moving(b))
    return Track(walk.ranges.subtracted(a.value, b.value), slope, here, rise)


def _multiply(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    a, b = args
    ranges = walk.ranges
    if a.here is b.here:
        return _square(walk, here, rise, a)
    bend = _scaled_bend(a, b) if not a.moves else _scaled_bend(b, a) if not b.moves else Bend.UNKNOWN
    positive = a.is_positive and b.is_positive
    if bend is not Bend.UNKNOWN:
        return walk.curved(here, rise, bend, positive)
    value = ranges.multiplied(a.value, b.value, a.is_positive, b.is_positive)
    terms = [
        ranges.multiplied(still.value, moving.slope, still.is_positive)
        for still, moving in ((b, a), (a, b))
        if moving.slope is not None
    ]
    return Track(value, ranges.sum(terms), here, rise, Bend.UNKNOWN, positive)


def _scaled_bend(factor: Track, moving: Track) -> Bend:
    """The bend of a product with what does not move."""
    if moving.bend in (Bend.AFFINE, Bend.UNKNOWN) or factor.is_positive:
        return moving.bend
    return moving.bend.mirrored if factor.here.is_constant else Bend.UNKNOWN


def _square(walk: Walk, here: Expr, rise: Expr, a: Track) -> Track:
    if a.bend is Bend.AFFINE or (a.bend is Bend.CONVEX and a.is_positive):
        return walk.curved(here, rise, Bend.CONVEX, True)
    slope = walk.ranges.multiplied(a.value, walk.moving(a), a.is_positive)
    return Track(
        walk.ranges.squared(a.value), walk.ranges.added(slope, slope), here, rise, Bend.UNKNOWN, is_positive=True
    )


def _divide(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    a, b = args
    ranges = walk.ranges
    if not b.moves:
        bend = _scaled_bend(b, a)
        if bend is not Bend.UNKNOWN:
            return walk.curved(here, rise, bend, a.is_positive and b.is_positive)
    over = ranges.reciprocal(b.value, b.is_positive)
    value = ranges.multiplied(a.value, over, a.is_positive, b.is_positive)
    top = walk.moving(a)
    if b.slope is not None:
        top = ranges.subtracted(top, ranges.multiplied(value, b.slope, a.is_positive and b.is_positive))
    slope = ranges.multiplied(top, over, b_positive=b.is_positive)
    return Track(value, slope, here, rise, Bend.UNKNOWN, a.is_positive and b.is_positive)


# ---- kinks


def _abs(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
    (a,) = args
    if a.is_positive:
        return Track(a.value, a.slope, here, rise, a.bend, True)
    if a.bend is Bend.AFFINE:
        return walk.curved(here, rise, Bend.CONVEX, True)
    ranges, slope = walk.ranges, walk.moving(a)
    same, mirrored = ranges.slack < a.value.lo, a.value.hi < -ranges.slack
    turned = ranges.negated(slope)
    return Track(
        ranges.magnitude(a.value), ranges.chosen(same, mirrored, slope, turned), here, rise, Bend.UNKNOWN, True
    )


def _extremum(op: Op) -> Component:
    """min or max."""
    kept = Bend.CONCAVE if op is Op.MIN else Bend.CONVEX

    def rule(walk: Walk, here: Expr, rise: Expr, args: Sequence[Track]) -> Track:
        a, b = args
        g = walk.graph
        positive = [a.is_positive, b.is_positive]
        is_positive = all(positive) if op is Op.MIN else any(positive)
        if all(t.bend in (Bend.AFFINE, kept) for t in args):
            return walk.curved(here, rise, kept, is_positive)
        difference = walk.difference(a, b)
        below, above = difference.hi < -walk.ranges.slack, walk.ranges.slack < difference.lo
        first, second = (below, above) if op is Op.MIN else (above, below)
        slope = walk.ranges.chosen(first, second, walk.moving(a), walk.moving(b))
        value = Range(g.call(op, a.value.lo, b.value.lo), g.call(op, a.value.hi, b.value.hi))
        return Track(value, slope, here, rise, Bend.UNKNOWN, is_positive)

    return rule


# ---- choices


def _select(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    (condition,), then, otherwise = arguments
    g, ranges = walk.graph, walk.ranges
    certain, excluded = condition.value.lo, g.call(Op.NOT, condition.value.hi)
    tracks = []
    for i, (here, rise) in enumerate(walk.parts(node)):
        a, b = (t[i] if len(t) > 1 else t[0] for t in (then, otherwise))
        value = ranges.chosen(certain, excluded, a.value, b.value)
        slope = ranges.chosen(certain, excluded, walk.moving(a), walk.moving(b))
        if condition.moves:
            slope = functions.jumping_unless(walk, g.call(Op.OR, certain, excluded), slope)
        tracks.append(Track(value, slope, here, rise, Bend.UNKNOWN, a.is_positive and b.is_positive))
    return tuple(tracks)


# ---- vectors


def _vector(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    return tuple(a[0] for a in arguments)


def _swizzle(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    assert isinstance(node.value, tuple)
    (source,) = arguments
    return tuple(source[int(i)] for i in node.value)


def _dot(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    a, b = arguments
    g, ranges = walk.graph, walk.ranges
    ((here, rise),) = walk.parts(node)
    products = []
    for x, y in zip(a, b, strict=True):
        product = x.here * y.here
        if x.moves or y.moves:
            grown = (y.rise * x.here if y.rise is not None else g.constant(0.0)) + (
                x.rise * y.here if x.rise is not None else g.constant(0.0)
            )
            products.append(_multiply(walk, product, grown, [x, y]))
        else:
            products.append(Track(point(product), None, product, None, Bend.AFFINE))
    bend = reduce(Bend.plus, [t.bend for t in products])
    positive = all(t.is_positive for t in products)
    if bend is not Bend.UNKNOWN:
        return (walk.curved(here, rise, bend, positive),)
    slope = ranges.sum([t.slope for t in products if t.slope is not None])
    return (Track(ranges.sum([t.value for t in products]), slope, here, rise, bend, positive),)


def _length(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    """(v . v') / |v|, which Cauchy-Schwarz keeps within |v'|: also where v is 0."""
    (parts,) = arguments
    g, ranges = walk.graph, walk.ranges
    ((here, rise),) = walk.parts(node)
    if len(parts) == 1:
        return (_abs(walk, here, rise, parts),)
    if all(t.bend is Bend.AFFINE or (t.bend is Bend.CONVEX and t.is_positive) for t in parts):
        return (walk.curved(here, rise, Bend.CONVEX, True),)
    square = ranges.sum([ranges.squared(t.value) for t in parts])
    value = Range(g.sqrt(square.lo), g.sqrt(square.hi))
    moving = [(t, t.slope) for t in parts if t.slope is not None]
    top = ranges.sum([ranges.multiplied(t.value, slope, t.is_positive) for t, slope in moving])
    limits = [g.max(-slope.lo, slope.hi) if not slope.is_point else slope.lo for _, slope in moving]
    limit = g.abs(limits[0]) if len(limits) == 1 else g.length(g.vector(*limits))
    slope = ranges.clipped(ranges.multiplied(top, ranges.reciprocal(value, True), b_positive=True), limit)
    return (Track(value, slope, here, rise, Bend.UNKNOWN, True),)


# ---- conditions


def _compared(strict: bool) -> Rule:
    def rule(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
        (a,), (b,) = arguments
        return (_truth(walk, node, walk.ranges.less(walk.difference(a, b), strict)),)

    return rule


def _truth(walk: Walk, node: Expr, value: Range) -> Track:
    """Of a condition that moves: a select between constants jumps with it."""
    return Track(value, point(walk.graph.constant(0.0)), node)


def _equal(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    (a,), (b,) = arguments
    g, slack = walk.graph, walk.ranges.slack
    difference = walk.difference(a, b)
    apart = g.call(Op.OR, slack < difference.lo, difference.hi < -slack)
    return (_truth(walk, node, Range(g.boolean(False), g.call(Op.NOT, apart))),)


def _logic(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    (a,), (b,) = arguments
    g = walk.graph
    ends = (g.call(node.op, x, y) for x, y in zip(a.value, b.value, strict=True))
    return (_truth(walk, node, Range(*ends)),)


def _not(walk: Walk, node: Expr, arguments: Sequence[Tracks]) -> Tracks:
    ((a,),) = arguments
    g = walk.graph
    return (_truth(walk, node, Range(g.call(Op.NOT, a.value.hi), g.call(Op.NOT, a.value.lo))),)


RULES: dict[Op, Rule] = {
    Op.VECTOR: _vector,
    Op.SWIZZLE: _swizzle,
    Op.DOT: _dot,
    Op.LENGTH: _length,
    Op.NEG: by_component(_negate),
    Op.ABS: by_component(_abs),
    Op.SIGN: by_component(functions.step(Op.SIGN)),
    Op.FLOOR: by_component(functions.step(Op.FLOOR)),
    Op.ROUND: by_component(functions.step(Op.ROUND)),
    Op.SQRT: by_component(functions.SQUARE_ROOT),
    Op.SIN: by_component(functions.wave(Op.SIN)),
    Op.COS: by_component(functions.wave(Op.COS)),
    Op.TAN: by_component(functions.tangent),
    Op.ASIN: by_component(functions.arc(Op.ASIN)),
    Op.ACOS: by_component(functions.arc(Op.ACOS)),
    Op.ATAN: by_component(functions.ARC_TANGENT),
    Op.EXP: by_component(functions.EXPONENTIAL),
    Op.LOG: by_component(functions.logarithm),
    Op.ADD: by_component(_add),
    Op.SUB: by_component(_subtract),
    Op.MUL: by_component(_multiply),
    Op.DIV: by_component(_divide),
    Op.MIN: by_component(_extremum(Op.MIN)),
    Op.MAX: by_component(_extremum(Op.MAX)),
    Op.MOD: by_component(functions.modulo),
    Op.POW: by_component(functions.power),
    Op.ATAN2: by_component(functions.angle),
    Op.LESS: _compared(True),
    Op.LESS_EQUAL: _compared(False),
    Op.EQUAL: _equal,
    Op.AND: _logic,
    Op.OR: _logic,
    Op.NOT: _not,
    Op.SELECT: _select,
}
