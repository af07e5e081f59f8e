"""By what rule a field is stepped that has no closed form: the least work to come as near, on rays that are tried."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sdfc.facts.bend import Bends, core_of
from sdfc.facts.bounds import Bounds
from sdfc.facts.box import Box
from sdfc.facts.cost import cost
from sdfc.facts.exactness import exactness
from sdfc.facts.lipschitz import Lipschitz
from sdfc.facts.ranges import Ranges
from sdfc.field.graph import Expr, Type
from sdfc.shape.definition import Exactness
from sdfc.shape.graph import Apply
from sdfc.shape.lower import Lowering

_PARABOLA = 1.4  # what a step by a parabola costs, in steps by balls: 1.2 to 1.6, measured on llvmpipe
_BALL, _PIECE = 10.0, 40.0  # additions that a step takes besides the field's own
_DENSE = 0.6  # of what is counted for a piece, it takes: its many small operations wait for nothing (measured there)
_FLAT = 8.0  # times flatter than its steepest
_FEW = 8.0  # steps: no other rule pays where there are no more
_EXACT = (Exactness.EXACT, Exactness.EXACT_OUTSIDE)


@dataclass(frozen=True, slots=True)
class Rule:
    """Balls, unless the bend is known that a parabola is made of, or it goes `by_pieces`; and why, in words."""

    bend: Expr | None = None
    by_pieces: bool = False
    why: str = ""
    is_core: bool = False  # the field is its own core


class Rules:
    """Chooses, in the shape's own space."""

    def __init__(self, ranges: Ranges, bounds: Bounds, lipschitz: Lipschitz) -> None:
        self._ranges = ranges
        self._bounds = bounds
        self.bends = Bends(ranges, bounds, lipschitz)
        self._found: dict[tuple[int, Box, float, bool, bool], Rule | None] = {}

    def best(self, shape: Apply, region: Box, lipschitz: float, inside: bool, is_cut: bool) -> Rule | None:
        """The rule that costs least. `lipschitz` may be infinite: None where nothing else is known that holds.

        `is_cut`: it is in an intersection, where the solid is looked for a little deeper. The region is finite. Where
        params are live, the choice is made for the middle of their ranges.
        """
        region = region.rounded()  # like parts are alike wherever they are placed: they are looked at once
        key = shape.id, region, lipschitz, inside, is_cut
        if key not in self._found:
            if math.isfinite(lipschitz):
                self._found[key] = self._chosen(shape, region, lipschitz, inside, is_cut)
            else:
                self._found[key] = self._only(shape, region, inside)
        return self._found[key]

    def _only(self, shape: Apply, region: Box, inside: bool) -> Rule | None:
        from sdfc.field.trial import Trial

        value = self._value(shape, inside)
        for share in (0.0, 0.5, 1.0):
            if not Trial(value, region.lo, region.hi, self._params(share)).is_bounded():
                return None
        return Rule(by_pieces=True, why="no Lipschitz constant is known")

    def _chosen(self, shape: Apply, region: Box, lipschitz: float, inside: bool, is_cut: bool) -> Rule:
        from sdfc.field.trial import Trial

        bend = self.bends.bound(shape, region) if inside else None
        is_exact = exactness(shape)[shape.id] in _EXACT
        if bend is None and is_exact:
            return Rule()
        value = self._value(shape, inside)
        trial = Trial(value, region.lo, region.hi, self._params(0.5))
        slope = max(lipschitz, 1e-9)
        # deeper by the steepest slope: of a field that is flat where its surface is, much deeper
        if is_cut and not is_exact and _FLAT * trial.steepness() < slope:
            return Rule(by_pieces=True, why="it is far flatter where its surface is")
        steps = trial.balls(slope)
        least, best, tried = steps, Rule(), [f"{steps:.3g} steps by balls"]
        if bend is not None:
            core = core_of(shape, value)
            steps = trial.parabolas(core, slope, self._middle(bend))
            tried.append(f"{steps:.3g} by parabolas")
            if _PARABOLA * steps <= least:
                least, best = _PARABOLA * steps, Rule(bend, is_core=core is value)
        if least > _FEW and not is_exact:
            steps, price = trial.pieces(slope), self._price(value)
            tried.append(f"{steps:.3g} by pieces at {price:.2g} times the cost")
            if price * steps < least:
                best = Rule(by_pieces=True)
        return replace(best, why=", ".join(tried))

    def _value(self, shape: Apply, inside: bool) -> Expr:
        value = Lowering().value(shape, self._bounds.values.input("p"))
        return value if inside else -value

    def _price(self, value: Expr) -> float:
        """Of a step by pieces, in steps by balls."""
        from sdfc.field.span import span

        graph = value.graph
        ahead = span(value, graph.input("p"), graph.input("d"), graph.input("s", Type.FLOAT))
        return _DENSE * (cost([value, *ahead.value, *ahead.slope]) + _PIECE) / (cost([value]) + _BALL)

    def _middle(self, bend: Expr) -> float:
        """The bend at the middle values of the params."""
        from sdfc.field.numeric import Evaluator

        return max(float(Evaluator([bend])({}, self._params(0.5))[0]), 1e-6)

    def _params(self, share: float) -> dict[str, list[float]]:
        """Values of the params, so far along their ranges."""
        return {
            name: [a + share * (b - a) for a, b in zip(lo, hi, strict=True)]
            for name, (lo, hi) in self._ranges.of.items()
        }
