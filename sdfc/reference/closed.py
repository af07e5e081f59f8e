"""The float64 truth of hard CSG: ray intervals from `definition.claims.ray`, merged by `sdfc.reference.events`.

It reads a scene as it was written, before any pass, so it also tells whether the passes keep the solid. No field is
evaluated, but to sharpen the ends that a dear claim gives: it shares nothing else with `certify` but the rays.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias, assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.reference.certify import Certificate, Status
from sdfc.reference.events import Both, Either, FirstRun, Leaf, Solid, Without, first_runs
from sdfc.reference.sharpen import sharpened
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union, topological
from sdfc.shape.lower import lower_gauge, lower_ray
from sdfc.shape.stretch import largest_stretch

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

NUMBERS = 2**22  # ends of intervals held at once: 32 MiB an array
ENDLESS = 9e8  # an end beyond it stands for no end (plane, infinite cylinder)
ROUNDINGS = 64.0 * 2.0**-52  # of the largest coordinate: how far a closed form's own t may be off


def is_closed_form(shape: Shape) -> bool:
    """Whether every leaf of the shape has ray intervals in closed form."""
    return leaf_count(shape) is not None


def leaf_count(shape: Shape) -> int | None:
    """How many different leaves there are, or None where one has no ray intervals in closed form."""
    leaves = [node for node in topological(shape) if isinstance(node, Apply)]
    closed = all(not leaf.children and leaf.definition.claims.ray is not None for leaf in leaves)
    return len(leaves) if closed else None


def closed_roots(
    root: Shape,
    values: FieldGraph,
    o: Array,
    d: Array,
    t_start: float | Array,
    t_end: float | Array,
    params: Mapping[str, ArrayLike],
    *,
    thin: float,
    tolerance: float,
) -> Certificate:
    """The first entry of each ray o + t d, (3, n), into a shape of closed-form leaves: what `first_roots` says of it.

    Right to ROUNDINGS, which is not proved: [t_lo, t_hi] is wide enough for them. `thin` as in `first_roots`. Contested
    is what the solids grown and shrunk by `tolerance` answer differently:
    - MISS, and the grown solid is hit; or
    - HIT, and the shrunk solid is missed, or the run in which the grown solid is entered ends before that; or
    - a film was passed, or the run or a void of the ray is nearly one.
    """
    count = o.shape[1]
    start, end = (np.broadcast_to(np.asarray(t, float), (count,)) for t in (t_start, t_end))
    size = max(64, NUMBERS // max(1, 4 * (leaf_count(root) or 1)))
    parts = []
    for first in range(0, max(count, 1), size):
        part = slice(first, first + size)
        build = _Builder(values, o[:, part], d[:, part], params)
        solids = (build.solid(root, grow) for grow in (0.0, tolerance, -tolerance))
        exact, grown, shrunk = (first_runs(solid, start[part], end[part], thin) for solid in solids)
        parts.append(_certificate(o[:, part], d[:, part], exact, grown, shrunk, thin, tolerance))
    return joined(parts)


def joined(parts: list[Certificate]) -> Certificate:
    """What is known of all their rays, in order."""
    return Certificate(*(np.concatenate([getattr(part, name) for part in parts]) for name in Certificate.__slots__))


def _certificate(
    o: Array, d: Array, exact: FirstRun, grown: FirstRun, shrunk: FirstRun, thin: float, tolerance: float
) -> Certificate:
    speed = np.sqrt(np.sum(d * d, axis=0))
    largest = np.maximum(np.max(np.abs(o), axis=0), np.where(exact.hit, exact.t, 0.0) * speed)
    slack = ROUNDINGS * largest / speed
    thinnest = np.minimum(exact.thickness, exact.gap)
    contested = (exact.films > 0) | (exact.hit & (thinnest < 2.0 * thin))
    with np.errstate(invalid="ignore"):
        dip = ~(grown.t + grown.thickness >= shrunk.t)
    contested |= np.where(exact.hit, ~grown.hit | ~shrunk.hit | dip, grown.hit)
    status = np.where(exact.hit, Status.HIT, Status.MISS).astype(np.int8)
    clearance = np.where(~exact.hit & ~contested, tolerance, 0.0)
    return Certificate(status, exact.t - slack, exact.t + slack, clearance, grown.t, shrunk.t, contested)


class _Builder:
    """Ray intervals of shapes along some rays."""

    def __init__(self, values: FieldGraph, o: Array, d: Array, params: Mapping[str, ArrayLike]) -> None:
        self._values = values
        self._inputs = {"o": o, "d": d}
        self._params = params
        self._count = o.shape[1]

    def solid(self, root: Shape, grow: float) -> Solid:
        """The solid whose leaves are {gauge <= grow}, and >= where they are cut away."""
        graph = self._values
        return self._built(root, graph.input("o"), graph.input("d"), graph.constant(grow))

    def _built(self, shape: Shape, o: Expr, d: Expr, grow: Expr) -> Solid:
        match shape:
            case Union():
                return Either(tuple(self._built(c, o, d, grow) for c in shape.children))
            case Intersection():
                return Both(tuple(self._built(c, o, d, grow) for c in shape.children))
            case Complement():
                return Without(self._everything(), self._built(shape.child, o, d, -grow))
            case Affine():
                inside = largest_stretch(shape.inverse) * grow
                return self._built(shape.child, shape.inverse.apply(o), shape.inverse.direction(d), inside)
            case Paint():
                return self._built(shape.child, o, d, grow)
            case Apply():
                return self._leaf(shape, o, d, grow)
            case Nothing():
                return Leaf(*np.full((2, 1, self._count), np.nan))
            case _:
                assert_never(shape)

    def _everything(self) -> Leaf:
        end = np.full((1, self._count), np.inf)
        return Leaf(-end, end)

    def _leaf(self, shape: Apply, o: Expr, d: Expr, grow: Expr) -> Leaf:
        pairs = lower_ray(shape, o, d, grow)
        ends = Evaluator([end for pair in pairs for end in pair])(self._inputs, self._params)
        enter, leave = (np.stack([np.broadcast_to(e, (self._count,)) for e in ends[side::2]]) for side in (0, 1))
        if shape.definition.claims.ray_is_dear:
            enter, leave = sharpened(enter, leave, self._gauge(shape, o, d, grow))
        enter = np.where(np.abs(enter) > ENDLESS, np.sign(enter) * np.inf, enter)
        return Leaf(enter, np.where(leave > ENDLESS, np.inf, leave))

    def _gauge(self, shape: Apply, o: Expr, d: Expr, grow: Expr) -> Callable[[Array], Array]:
        """What is negative inside the leaf, at t (k, n) along the rays."""
        t = self._values.input("t", Type.FLOAT)
        evaluate = Evaluator([lower_gauge(shape, o + t * d) - grow])

        def gauge(values: Array) -> Array:
            rows = [evaluate({**self._inputs, "t": row}, self._params)[0] for row in values]
            return np.stack([np.broadcast_to(row, (self._count,)) for row in rows])

        return gauge
