"""What the CPU renderer evaluates of a part: its formulas in the scene's space as NumPy, each prepared when first used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdfc.field.derivative import directional, gradient
from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.plan.steps import Part
from sdfc.shape.graph import Apply
from sdfc.shape.lower import Lowering, lower_ray
from sdfc.shape.material import Material

Array = NDArray[np.float64]
Params = Mapping[str, tuple[float, ...]]

PROPERTIES = {
    "color": slice(0, 3),
    "metallic": slice(3, 4),
    "roughness": slice(4, 5),
    "emission": slice(5, 8),
    "transmission": slice(8, 9),
    "ior": slice(9, 10),
    "tint": slice(10, 13),
}
"""The rows of a stack of material properties, (13, n)."""


@dataclass(frozen=True, slots=True)
class Interval:
    """Where rays are inside a solid, in their own parameter: (n,) each; nowhere unless enter < leave."""

    enter: Array
    leave: Array


class Formulas:
    """The formulas of one scene at given values of its params, float64. Points and directions are (3, n)."""

    def __init__(self, graph: FieldGraph, params: Params) -> None:
        self._graph = graph
        self._params = params
        self._lowering = Lowering()
        self._evaluators: dict[tuple[str, int], Evaluator] = {}
        self._p, self._o, self._d = (graph.input(name) for name in "pod")

    def intervals(self, part: Part, o: Array, d: Array, grow: float) -> list[Interval]:
        """The closed-form intervals of the rays with the part, the solid `grow` larger (a length in the scene)."""

        def roots() -> list[Expr]:
            own_o, own_d = self._o, self._d
            if part.inverse is not None:
                own_o, own_d = part.inverse.apply(own_o), part.inverse.direction(own_d)
            pairs = lower_ray(part.shape, own_o, own_d, part.own_grow * grow)
            return [end for pair in pairs for end in pair]

        ends = self._evaluate(f"ray {grow}", id(part), roots, {"o": o, "d": d})
        ends = [np.broadcast_to(e, o.shape[1:]) for e in ends]
        return [Interval(enter, leave) for enter, leave in zip(ends[::2], ends[1::2], strict=True)]

    def value(self, part: Part, p: Array) -> Array:
        """The part's formula, (n,), in the scene's units."""
        return self._one("value", part, lambda: self._formula(part), p)

    def slope(self, part: Part, p: Array, d: Array) -> tuple[Array, Array]:
        """A convex function of the part and its derivative along d, (n,) each."""

        def roots() -> list[Expr]:
            value = self._sharp(part)
            return [value, directional(value, {self._p: self._d})]

        value, along = self._evaluate("slope", id(part), roots, {"p": p, "d": d})
        return np.broadcast_to(value, p.shape[1:]), np.broadcast_to(along, p.shape[1:])

    def surface(self, part: Part, p: Array, formula: bool = False) -> Array:
        """Gradient and value, (4, n), of a function whose zero set is the surface; of the formula itself if asked."""

        def roots() -> list[Expr]:
            value = self._formula(part) if formula else self._sharp(part)
            normal = gradient(value, self._p)
            return [self._graph.vector(normal[0], normal[1], normal[2], value)]

        (field,) = self._evaluate(f"surface {formula}", id(part), roots, {"p": p})
        return np.broadcast_to(field, (4, p.shape[1]))

    def weights(self, blend: Apply, a: Array, b: Array) -> tuple[Array, Array, Array]:
        """A blend's derivatives by its two operands, and its value, (n,) each, for the operands' values."""

        def roots() -> list[Expr]:
            graph = self._graph
            values = [graph.input(name, Type.FLOAT) for name in ("a", "b")]
            children: dict[str, Callable[[Expr], Expr]] = {
                parameter.name: lambda _, value=value: value
                for parameter, value in zip(blend.definition.children, values, strict=True)
            }
            result = blend.definition.formula(self._p, blend.environment, children)
            one = graph.constant(1.0)
            return [*(directional(result, {value: one}) for value in values), result]

        first, second, value = self._evaluate("weights", blend.id, roots, {"a": a, "b": b})
        return np.broadcast_to(first, a.shape), np.broadcast_to(second, a.shape), np.broadcast_to(value, a.shape)

    def stretch(self, part: Part) -> float:
        """What a value in the part's own space is multiplied with, at these params."""
        return float(self.constant(part.stretch)[0])

    def constant(self, value: Expr) -> Array:
        """The components of an expression over params alone."""
        if value.is_constant:
            return np.array(value.numbers)
        return np.ravel(Evaluator([value])({}, self._params)[0])

    def material(self, material: Material) -> Array:
        """Its properties, (13,), in the order of PROPERTIES."""
        return np.concatenate([self.constant(getattr(material, name)) for name in PROPERTIES])

    def call(self, function: Function, arguments: Mapping[str, Array]) -> Array:
        """A shading function over arrays: (n,) for a FLOAT, (k, n) for a VECk; (k, 1) is the same for all points."""
        return self._evaluate(function.name, -1, lambda: [function.result], arguments)[0]

    def _formula(self, part: Part) -> Expr:
        q = self._p if part.inverse is None else part.inverse.apply(self._p)
        return self._lowering.value(part.shape, q) * part.stretch

    def _sharp(self, part: Part) -> Expr:
        """The primitive's gauge where there is one: its gradient is sharp at edges, and convex where the solid is."""
        gauge = part.shape.definition.claims.gauge
        if gauge is None or not part.shape.definition.is_primitive:
            return self._formula(part)
        q = self._p if part.inverse is None else part.inverse.apply(self._p)
        return gauge(q, part.shape.environment) * part.stretch

    def _one(self, role: str, part: Part, root: Callable[[], Expr], p: Array) -> Array:
        (value,) = self._evaluate(role, id(part), lambda: [root()], {"p": p})
        return np.broadcast_to(value, p.shape[1:])

    def _evaluate(
        self, role: str, owner: int, roots: Callable[[], list[Expr]], inputs: Mapping[str, Array]
    ) -> list[Array]:
        key = (role, owner)
        if key not in self._evaluators:
            self._evaluators[key] = Evaluator(roots())
        return self._evaluators[key](inputs, self._params)
