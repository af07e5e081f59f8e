"""The float64 truth of hard CSG: ray intervals from `definition.claims.ray`, merged by `sdfc.reference.events`.

It reads the scene as it was written, before any pass, so it also tells whether the passes keep the solid.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.field.graph import Expr, Type
from sdfc.field.numeric import Evaluator
from sdfc.pipeline import Compiled
from sdfc.plan.prove import Rays
from sdfc.reference.events import Both, Either, FirstRun, Leaf, Solid, Without, first_runs
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Paint, Shape, Union, topological
from sdfc.shape.lower import lower_gauge, lower_ray
from sdfc.shape.stretch import largest_stretch

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class ClosedTruth:
    """First hits of n rays: of the solid itself, and of all that an error of `near` may make of it.

    The ray's answer is contested where the solid grown and the solid shrunk by `near` do not agree that it hits, and
    where a run is thinner than `thin`. A hit belongs in [early, late].
    """

    hit: Mask
    t: Array
    early: Array
    late: Array
    contested: Mask


def is_closed_form(shape: Shape, rays: Rays = "cheap") -> bool:
    """Whether every leaf of the shape has ray intervals in closed form, among those that a plan with `rays` uses."""
    claims = [node.definition.claims for node in topological(shape) if isinstance(node, Apply)]
    return all(c.ray is not None and (rays == "all" or not c.ray_is_dear) for c in claims)


def closed_truth(compiled: Compiled, o: Array, d: Array, near: float, thin: float) -> ClosedTruth:
    """`o`, `d`: (3, n) in the compiled scene's own coordinates; `near` and `thin` are in them too."""
    frame = compiled.frame
    centre = np.array(frame.centre)[:, None]
    origin, direction = o * frame.radius + centre, d * frame.radius

    def run(grow: float) -> FirstRun:
        with pipeline.deep_recursion():
            solid = _Builder(compiled, origin, direction).solid(grow * frame.radius)
        return first_runs(solid, 0.0, np.inf, thin)

    exact, grown, shrunk = run(0.0), run(near), run(-near)
    thinnest = np.minimum(exact.thickness, exact.gap)
    unclear = (grown.hit != shrunk.hit) | (exact.films > 0) | (exact.hit & (thinnest < 2.0 * thin))
    return ClosedTruth(exact.hit, exact.t, grown.t, shrunk.t, unclear)


class _Builder:
    def __init__(self, compiled: Compiled, o: Array, d: Array) -> None:
        self._scene = compiled.scene
        self._inputs = {"o": o, "d": d}
        self._params = {p.name: p.default for p in compiled.scene.params}
        self._count = o.shape[1]

    def solid(self, grow: float) -> Solid:
        graph = self._scene.values
        return self._built(self._scene.root, graph.input("o"), graph.input("d"), graph.constant(grow))

    def _built(self, shape: Shape, o: Expr, d: Expr, grow: Expr) -> Solid:
        match shape:
            case Union() if shape.children:
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
            case _:
                return Leaf(*np.full((2, 1, self._count), np.nan))

    def _everything(self) -> Leaf:
        end = np.full((1, self._count), np.inf)
        return Leaf(-end, end)

    def _leaf(self, shape: Apply, o: Expr, d: Expr, grow: Expr) -> Leaf:
        pairs = lower_ray(shape, o, d, grow)
        ends = Evaluator([end for pair in pairs for end in pair])(self._inputs, self._params)
        enter, leave = (np.stack([np.broadcast_to(e, (self._count,)) for e in ends[side::2]]) for side in (0, 1))
        if shape.definition.claims.ray_is_dear:
            enter, leave = self._sharpened(shape, o, d, grow, enter, leave)
        return Leaf(np.where(np.abs(enter) > 9e8, np.sign(enter) * np.inf, enter), np.where(leave > 9e8, np.inf, leave))

    def _sharpened(
        self, shape: Apply, o: Expr, d: Expr, grow: Expr, enter: Array, leave: Array
    ) -> tuple[Array, Array]:
        """Ends that are right to float32's last digits, as iterations made for it leave them, to float64's."""
        t = self._scene.values.input("t", Type.FLOAT)
        gauge = Evaluator([lower_gauge(shape, o + t * d) - grow])

        def at(value: Array) -> Array:
            rows = [gauge({**self._inputs, "t": row}, self._params)[0] for row in value]
            return np.stack([np.broadcast_to(row, (self._count,)) for row in rows])

        some = enter < leave
        middle, half = np.where(some, (enter + leave) / 2, 0.0), np.where(some, (leave - enter) / 2, 0.0)
        ends = []
        for end, outward in ((enter, -1.25), (leave, 1.25)):
            low, high = middle, middle + outward * half
            clear = some & (at(low) < 0) & (at(high) > 0)
            for _ in range(60):
                between = (low + high) / 2
                inside = at(between) < 0
                low, high = np.where(inside, between, low), np.where(inside, high, between)
            ends.append(np.where(clear, (low + high) / 2, end))
        return ends[0], ends[1]
