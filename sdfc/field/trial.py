"""Rays tried in float64 before a rule is chosen: the steps that each rule takes to the surface; what is unbounded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sdfc.field.derivative import directional, gradient
from sdfc.field.graph import Expr, Type
from sdfc.field.memory import MEMORY, fingerprint, params_fingerprint
from sdfc.field.numeric import Evaluator
from sdfc.field.piece import SHORT, look
from sdfc.field.span import span
from sdfc.field.span_ranges import HUGE

Array = NDArray[np.float64]
Params: TypeAlias = Mapping[str, ArrayLike]
Rule: TypeAlias = Callable[["_Rays", Array, NDArray[np.int64]], Array]  # rays, t, which: how far is clear

RAYS = 256
MOST = 80  # steps: what takes longer is long either way
_LATE = 16 * MOST  # what a ray still counts that is not there by then: its tracer would stop too early
NEAR = 1e-5  # of the box: what counts as there
_CUTS = 16  # of a piece that no bound is known for, before it counts as one
_STEEP = 1e-4 * HUGE  # what is steeper may be a jump
_PIECES = 16  # of a ray, to begin with
_LESS = 0.6  # of what it may change by in a piece, what it may in one that was cut for half of _CUTS


@dataclass(frozen=True, slots=True)
class _Rays:
    """Rays through a box, from all sides: origins, unit directions (3, n), the box's interval (n,), its radius."""

    o: Array
    d: Array
    first: Array
    last: Array
    radius: float

    def at(self, t: Array, which: NDArray[np.int64]) -> dict[str, Array]:
        return {"p": self.o[:, which] + t * self.d[:, which], "d": self.d[:, which]}


class Trial:
    """Tries rules on one field in one box (FLOAT in the VEC3 `p`), at given values of the params.

    All are asked to come as near to the surface: by its distance, which is the value over the gradient's length.
    """

    def __init__(self, value: Expr, lo: Sequence[float], hi: Sequence[float], params: Params) -> None:
        self._value = value
        self._p, self._d = value.graph.input("p"), value.graph.input("d")
        self._rays = _through(np.array(lo)[:, None], np.array(hi)[:, None])
        self._params = params
        self._question = fingerprint([value]), tuple(lo), tuple(hi), params_fingerprint(params)

    def steepness(self) -> float:
        """The gradient's length where rays first meet the surface, of most of them; infinite where none does."""
        return MEMORY.recall(("steepness", self._question), self._steepness)

    def balls(self, lipschitz: float) -> float:
        """Mean steps of a ray by empty balls."""
        return MEMORY.recall(("balls", self._question, lipschitz), lambda: self._mean(self._by_balls(lipschitz)))

    def parabolas(self, core: Expr, lipschitz: float, bend: float) -> float:
        """Mean steps by the roots of the parabolas below the field's core, or by balls where these are more."""
        question = "parabolas", self._question, fingerprint([core]), lipschitz, bend
        return MEMORY.recall(question, lambda: self._mean(self._by_parabolas(core, lipschitz, bend)))

    def pieces(self, lipschitz: float) -> float:
        """Mean steps by what is known of the pieces of the ray ahead; the constant may be infinite."""
        return MEMORY.recall(("pieces", self._question, lipschitz), lambda: self._mean(self._by_pieces(lipschitz)))

    def is_bounded(self) -> bool:
        """Whether spans bound the field along rays, however short they must be: it has no jump, and no pole."""
        return MEMORY.recall(("is bounded", self._question), self._is_bounded)

    @cached_property
    def _near(self) -> Evaluator:
        """The value and its gradient."""
        return Evaluator([self._value, gradient(self._value, self._p)])

    def _steepness(self) -> float:
        rays, which = self._rays, np.arange(RAYS)
        length = rays.last - rays.first
        met = np.full(RAYS, np.nan)
        for share in np.linspace(0.0, 1.0, 4 * _PIECES):
            t = rays.first + share * length
            value, slope = self._near(rays.at(t, which), self._params)
            steep = np.linalg.norm(np.broadcast_to(slope, (3, RAYS)), axis=0)
            met = np.where(np.isnan(met) & (np.broadcast_to(value, (RAYS,)) <= 0.0), steep, met)
        met = met[np.isfinite(met)]
        return float(np.median(met)) if met.size else np.inf

    def _by_balls(self, lipschitz: float) -> Rule:
        evaluate = Evaluator([self._value])

        def rule(rays: _Rays, t: Array, which: NDArray[np.int64]) -> Array:
            (value,) = evaluate(rays.at(t, which), self._params)
            return np.broadcast_to(value / lipschitz, t.shape)

        return rule

    def _by_parabolas(self, core: Expr, lipschitz: float, bend: float) -> Rule:
        evaluate = Evaluator([self._value, core, directional(core, {self._p: self._d})])

        def rule(rays: _Rays, t: Array, which: NDArray[np.int64]) -> Array:
            found = evaluate(rays.at(t, which), self._params)
            value, above, slope = (np.broadcast_to(a, t.shape) for a in found)
            return np.maximum(value / lipschitz, _root(np.maximum(above, 0.0), slope, bend))

        return rule

    def _by_pieces(self, lipschitz: float) -> Rule:
        evaluate = self._spans()
        ahead = self._rays.last - self._rays.first

        def rule(rays: _Rays, t: Array, which: NDArray[np.int64]) -> Array:
            eps = np.full(t.shape, NEAR * rays.radius)
            length = np.maximum(np.minimum(ahead[which], rays.last[which] - t), SHORT * eps)
            found = evaluate({**rays.at(t, which), "s": length}, self._params)
            value, *bounds = (np.broadcast_to(a, t.shape) for a in found)
            clear, there, ahead[which] = look(length, value, _four(bounds), lipschitz, np.zeros(1), eps)
            return np.where(there, 0.0, np.maximum(clear, 1e-12))

        return rule

    def _is_bounded(self) -> bool:
        """Pieces without a bound of the slope are cut: the shorter they are, the less the value must be able to change.
        Where cells of a repetition meet it is as if it jumped, whatever the value really does: all of a cell is met.
        """
        evaluate, rays = self._spans(), self._rays
        which = np.repeat(np.arange(RAYS), _PIECES)
        length = (rays.last - rays.first)[which] / _PIECES
        start = rays.first[which] + np.tile(np.arange(_PIECES), RAYS) * length
        wide = np.full(start.shape, np.inf)
        for cut in range(_CUTS):
            found = evaluate({**rays.at(start, which), "s": length}, self._params)
            _, low, high, fall, rise = (np.broadcast_to(a, start.shape) for a in found)
            known = (fall > -_STEEP) & (rise < _STEEP) & (low > -_STEEP) & (high < _STEEP)
            if known.all():
                return True
            if cut + 1 == _CUTS:
                return bool((known | (high - low < _LESS * wide)).all())
            wide = np.where(cut == _CUTS // 2, high - low, wide)
            some = np.flatnonzero(~known)[: 8 * RAYS]
            which, length, wide = np.tile(which[some], 2), np.tile(0.5 * length[some], 2), np.tile(wide[some], 2)
            start = np.concatenate([start[some], start[some] + length[: some.size]])
        raise AssertionError("the last cut decides")

    def _spans(self) -> Evaluator:
        ahead = span(self._value, self._p, self._d, self._value.graph.input("s", Type.FLOAT))
        return Evaluator([self._value, *ahead.value, *ahead.slope])

    def _mean(self, rule: Rule) -> float:
        rays = self._rays
        t, which, taken = rays.first.copy(), np.arange(RAYS), 0
        for _ in range(MOST):
            if not which.size:
                break
            taken += which.size
            value, slope = self._near(rays.at(t[which], which), self._params)
            steep = np.maximum(np.linalg.norm(np.broadcast_to(slope, (3, which.size)), axis=0), 1e-9)
            there = np.broadcast_to(value, which.shape) <= NEAR * rays.radius * steep
            clear = np.nan_to_num(rule(rays, t[which], which))
            t[which] += np.maximum(clear, 0.0)
            which = which[~there & (clear > 0.0) & (t[which] < rays.last[which])]
        return (taken + _LATE * which.size) / RAYS


def _four(bounds: Sequence[Array]) -> tuple[Array, Array, Array, Array]:
    low, high, fall, rise = bounds
    return low, high, fall, rise


def _through(low: Array, high: Array) -> _Rays:
    """The same rays every time."""
    random = np.random.default_rng(20)
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    away = random.normal(size=(3, RAYS))
    o = middle + 3.0 * radius * away / np.linalg.norm(away, axis=0)
    d = random.uniform(low, high, (3, RAYS)) - o
    d /= np.linalg.norm(d, axis=0)
    with np.errstate(divide="ignore"):
        ends = (low - o) / d, (high - o) / d
    return _Rays(o, d, np.minimum(*ends).max(axis=0), np.maximum(*ends).min(axis=0), radius)


def _root(above: Array, slope: Array, bend: float) -> Array:
    """Where above + slope x - bend x x / 2 comes down to 0."""
    root = np.sqrt(slope * slope + 2.0 * bend * above)
    falling = slope < 0.0
    return np.where(falling, 2.0 * above / np.where(falling, root - slope, 1.0), (slope + root) / bend)
