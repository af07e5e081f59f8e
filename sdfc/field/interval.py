"""Intervals of an expression over boxes of inputs, and of an expression and its slope along segments of rays.

Everything is rounded outward: the answer encloses the value in real arithmetic, and the one that float64 computes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from sdfc.field.graph import LEAVES, Expr, Op, topological
from sdfc.field.interval_jumps import JUMPS, Sides
from sdfc.field.interval_rules import (
    RULES,
    Array,
    Interval,
    added,
    down,
    hull,
    multiplied,
    settled,
    up,
)
from sdfc.field.interval_slopes import SLOPES, STILL, Slope
from sdfc.field.order import evaluation_order

# a param's value, or a pair (lo, hi) of values
Parameters: TypeAlias = Mapping[str, ArrayLike]

CHUNK = 8192  # points at a time: a vector's end points then stay in the second-level cache


@dataclass(frozen=True, slots=True)
class RaySlab:
    """A function over a segment [t_lo, t_hi] of each ray: its value and its derivative in t; each (n,)."""

    lo: Array
    hi: Array
    slope_lo: Array
    slope_hi: Array

    def __iter__(self) -> Iterator[Array]:
        return iter((self.lo, self.hi, self.slope_lo, self.slope_hi))


class IntervalEvaluator:
    """Evaluates one expression over intervals. Made once for an expression, used for many boxes and rays."""

    def __init__(self, root: Expr) -> None:
        self.root = root
        self._nodes = evaluation_order([root])
        self._last_use = _last_uses(self._nodes)

    @property
    def size(self) -> int:
        """How many nodes there are: what an evaluation costs."""
        return len(self._nodes)

    def value(
        self,
        inputs: Mapping[str, tuple[ArrayLike, ArrayLike]],
        params: Parameters | None = None,
    ) -> tuple[Array, Array]:
        """Bounds of the root over boxes.

        `inputs`: name -> (lo, hi), a FLOAT's (n,), a VECk's (k, n); the result likewise. `params`: name -> a value or a
        pair (lo, hi) of values.
        """
        boxes = {name: _interval(lo, hi) for name, (lo, hi) in inputs.items()}
        values = _parameters(self._nodes, params or {})
        count = max((box.lo.shape[-1] for box in boxes.values()), default=1)
        chunks = [
            self._run({name: _columns(box, part) for name, box in boxes.items()}, values, None)[0]
            for part in _parts(count)
        ]
        return _joined([c.lo for c in chunks], count), _joined([c.hi for c in chunks], count)

    def along_ray(
        self,
        o: Array,
        d: Array,
        t_lo: Array,
        t_hi: Array,
        params: Parameters | None = None,
        centred: bool = False,
    ) -> RaySlab:
        """Bounds of root(o + t d) and of its derivative in t over t_lo <= t <= t_hi.

        `o`, `d`: (3, n), (2, n) or, for the plane, whatever the size of the input `p` is. The derivative is Clarke's;
        [-inf, inf] where the root may jump. `centred` also intersects the value with the mean value form about the
        segment's middle, for one more evaluation at a point.
        """
        values = _parameters(self._nodes, params or {})
        slabs = [
            self._slab(o[:, part], d[:, part], Interval(t_lo[part], t_hi[part]), values, centred)
            for part in _parts(t_lo.shape[0])
        ]
        count = t_lo.shape[0]
        return RaySlab(*(_joined([getattr(s, end) for s in slabs], count) for end in RaySlab.__slots__))

    def at(self, o: Array, d: Array, t: Array, params: Parameters | None = None) -> tuple[Array, Array]:
        """Bounds of root(o + t d) at single points; about a third of the cost of `along_ray`."""
        values = _parameters(self._nodes, params or {})
        chunks = []
        for part in _parts(t.shape[0]):
            points = _points_on_rays(o[:, part], d[:, part], Interval(t[part], t[part]))
            chunks.append(self._run({"p": points}, values, None)[0])
        return _joined([c.lo for c in chunks], t.shape[0]), _joined([c.hi for c in chunks], t.shape[0])

    def between(
        self, o: Array, d: Array, t_lo: Array, t_hi: Array, params: Parameters | None = None
    ) -> tuple[Array, Array]:
        """Bounds of root(o + t d) over t_lo <= t <= t_hi: `along_ray` without the derivative, for half of its cost."""
        values = _parameters(self._nodes, params or {})
        chunks = []
        for part in _parts(t_lo.shape[0]):
            points = _points_on_rays(o[:, part], d[:, part], Interval(t_lo[part], t_hi[part]))
            chunks.append(self._run({"p": points}, values, None)[0])
        return _joined([c.lo for c in chunks], t_lo.shape[0]), _joined([c.hi for c in chunks], t_lo.shape[0])

    def across_jumps(
        self, o: Array, d: Array, t_lo: Array, t_hi: Array, params: Parameters | None = None
    ) -> tuple[Array, Array]:
        """Bounds of root(o + t d) over t_lo <= t <= t_hi like `along_ray`'s, without what lies in a jump.

        That is, the union of both sides of up to MAX_JUMPS jumps instead of the hull across them. It may leave out
        isolated points: see `interval_jumps`.
        """
        values = _parameters(self._nodes, params or {})
        chunks = [
            self._united(_points_on_rays(o[:, part], d[:, part], Interval(t_lo[part], t_hi[part])), values)
            for part in _parts(t_lo.shape[0])
        ]
        count = t_lo.shape[0]
        return _joined([c.lo for c in chunks], count), _joined([c.hi for c in chunks], count)

    def value_across_jumps(self, lo: Array, hi: Array, params: Parameters | None = None) -> tuple[Array, Array]:
        """Bounds of the root over boxes lo <= p <= hi, (3, n) each, like `across_jumps`'s over segments."""
        values = _parameters(self._nodes, params or {})
        chunks = [self._united(Interval(lo[:, part], hi[:, part]), values) for part in _parts(lo.shape[1])]
        return _joined([c.lo for c in chunks], lo.shape[1]), _joined([c.hi for c in chunks], lo.shape[1])

    def _united(self, points: Interval, values: Mapping[str, Interval]) -> Interval:
        result: Interval | None = None
        most, combination = 0, 0
        while combination < 2**most:
            sides = Sides(combination, points.lo.shape[-1])
            value, _ = self._run({"p": points}, values, None, sides)
            most = max(most, int(sides.jumps.max(initial=0)))
            result = value if result is None else hull(result, value)
            combination += 1
        assert result is not None
        return result

    def directional(
        self, box: tuple[Array, Array], direction: Array, params: Parameters | None = None
    ) -> tuple[Array, Array]:
        """Bounds of the root's derivative along `direction` (k, n) over boxes of `p`, (k, n) each end."""
        return self.slope(Interval(*box), direction, _parameters(self._nodes, params or {}))

    def slope(self, box: Interval, direction: Array, params: Mapping[str, Interval]) -> tuple[Array, Array]:
        """As `directional`. A param has one interval for all boxes, (1,) or (k, 1), or one for each, (n,) or (k, n)."""
        slopes = []
        for part in _parts(direction.shape[1]):
            seed = direction[:, part]
            values = {name: _columns(interval, part) for name, interval in params.items()}
            _, slope = self._run({"p": _columns(box, part)}, values, {"p": Interval(seed, seed)})
            slopes.append(_known(slope))
        count = direction.shape[1]
        return _joined([s.lo for s in slopes], count), _joined([s.hi for s in slopes], count)

    def _slab(self, o: Array, d: Array, t: Interval, values: Mapping[str, Interval], centred: bool) -> RaySlab:
        value, slope = self._run({"p": _points_on_rays(o, d, t)}, values, {"p": Interval(d, d)})
        slope = _known(slope)
        if centred:
            value = self._centred(o, d, t, values, value, slope)
        return RaySlab(*np.broadcast_arrays(value.lo, value.hi, slope.lo, slope.hi, t.lo)[:4])

    def _centred(
        self, o: Array, d: Array, t: Interval, values: Mapping[str, Interval], value: Interval, slope: Interval
    ) -> Interval:
        middle = t.lo + 0.5 * (t.hi - t.lo)
        at_middle, _ = self._run({"p": _points_on_rays(o, d, Interval(middle, middle))}, values, None)
        offset = Interval(down(t.lo - middle), up(t.hi - middle))
        mean = settled(added(at_middle, multiplied(slope, offset)))
        return Interval(np.maximum(value.lo, mean.lo), np.minimum(value.hi, mean.hi))

    def _run(
        self,
        inputs: Mapping[str, Interval],
        params: Mapping[str, Interval],
        seeds: Mapping[str, Interval] | None,
        sides: Sides | None = None,
    ) -> tuple[Interval, Slope]:
        """Value and, where `seeds` gives the inputs' derivatives, slope of the root. Frees temporaries as it goes."""
        values: dict[int, Interval] = {}
        slopes: dict[int, Slope] = {}
        with np.errstate(all="ignore"):
            for position, node in enumerate(self._nodes):
                if node.op in LEAVES:
                    value = _LEAF[node.op](node, inputs, params)
                    slope = seeds.get(str(node.value)) if seeds is not None and node.op is Op.INPUT else None
                else:
                    arguments = [values[a.id] for a in node.args]
                    value = RULES[node.op](node, arguments)
                    if sides is not None and node.op in JUMPS:
                        value = sides.take(node, arguments, value)
                    slope = None
                    if seeds is not None:
                        moving = [slopes[a.id] for a in node.args]
                        if any(s is not None for s in moving):
                            slope = SLOPES[node.op](node, arguments, moving, value)
                values[node.id], slopes[node.id] = value, slope
                for finished in self._last_use[position]:
                    del values[finished], slopes[finished]
            return settled(values[self.root.id]), slopes[self.root.id]


class ConstantBounds:
    """Bounds of expressions without inputs, over one range of each param; what they share is computed once."""

    def __init__(self, params: Parameters) -> None:
        self._params = params
        self._found: dict[Expr, Interval] = {}

    def __call__(self, root: Expr) -> Interval:
        """Of the root's components, (k,) each end."""
        nodes = topological([root], lambda node: () if node in self._found else node.args)
        fresh = [node for node in nodes if node not in self._found]
        values = _parameters(fresh, self._params)
        with np.errstate(all="ignore"):
            for node in fresh:
                if node.op in LEAVES:
                    self._found[node] = _LEAF[node.op](node, {}, values)
                else:
                    self._found[node] = RULES[node.op](node, [self._found[a] for a in node.args])
        lo, hi = settled(self._found[root])
        return Interval(lo.ravel(), hi.ravel())


def _last_uses(nodes: Sequence[Expr]) -> list[list[int]]:
    """For each position, the ids of the nodes that nothing after it needs."""
    last: dict[int, int] = {}
    for position, node in enumerate(nodes):
        for argument in node.args:
            last[argument.id] = position
    result: list[list[int]] = [[] for _ in nodes]
    for identity, position in last.items():
        result[position].append(identity)
    return result


def _constant(node: Expr, inputs: Mapping[str, Interval], params: Mapping[str, Interval]) -> Interval:
    values = np.array(node.numbers)
    column = values if node.type.size == 1 else values[:, None]
    return Interval(column, column)


_LEAF: dict[Op, Callable[[Expr, Mapping[str, Interval], Mapping[str, Interval]], Interval]] = {
    Op.CONST: _constant,
    Op.INPUT: lambda node, inputs, params: inputs[str(node.value)],
    Op.PARAM: lambda node, inputs, params: params[str(node.value)],
}


def _interval(lo: ArrayLike, hi: ArrayLike) -> Interval:
    """A pair of arrays of at least one column."""
    low, high = np.broadcast_arrays(np.atleast_1d(np.asarray(lo, float)), np.atleast_1d(np.asarray(hi, float)))
    return Interval(low, high)


def _parameters(nodes: Sequence[Expr], params: Parameters) -> dict[str, Interval]:
    """An interval for every PARAM node: a number, a vector's components, or a pair of either."""
    result = {}
    for node in nodes:
        if node.op is Op.PARAM:
            shape = (1,) if node.type.value <= 1 else (node.type.size, 1)
            given = np.asarray(params[str(node.value)], float)
            if given.size == node.type.size:
                only = given.reshape(shape)
                result[str(node.value)] = Interval(only, only)
            else:
                lo, hi = given.reshape(2, *shape)
                result[str(node.value)] = Interval(lo, hi)
    return result


def _parts(count: int) -> list[slice]:
    return [slice(start, min(start + CHUNK, count)) for start in range(0, max(count, 1), CHUNK)]


def _columns(box: Interval, part: slice) -> Interval:
    if box.lo.shape[-1] == 1:
        return box
    lo = box.lo[..., part]
    return Interval(lo, lo if box.lo is box.hi else box.hi[..., part])


def _joined(chunks: Sequence[Array], count: int) -> Array:
    """The chunks side by side; what does not depend on the points is repeated."""
    if len(chunks) == 1:
        only = chunks[0]
        return only if only.shape[-1] == count else np.repeat(only, count, axis=-1)
    return np.concatenate([_full(c, part) for c, part in zip(chunks, _parts(count), strict=True)], axis=-1)


def _full(chunk: Array, part: slice) -> Array:
    size = part.stop - part.start
    return chunk if chunk.shape[-1] == size else np.repeat(chunk, size, axis=-1)


def _known(slope: Slope) -> Interval:
    return STILL if slope is None else settled(slope)


def _points_on_rays(o: Array, d: Array, t: Interval) -> Interval:
    """o + t d over each segment: (k, n)."""
    with np.errstate(all="ignore"):
        return added(Interval(o, o), multiplied(Interval(t.lo, t.lo) if t.lo is t.hi else t, Interval(d, d)))
