"""What the CPU renderer evaluates of a part: its formulas in the scene's space, each prepared when first used."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdfc.facts.bend import core_of
from sdfc.field.derivative import directional, gradient
from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.field.span import span
from sdfc.plan.steps import Part
from sdfc.shape.definition import FORMAL, Environment
from sdfc.shape.graph import Apply
from sdfc.shape.look import Looks
from sdfc.shape.lower import FAR, Lowering
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix

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


def first_inside(intervals: list[Interval], t: Array) -> Array:
    """The first parameter at or after t inside one of the intervals."""
    answer = np.full(t.shape, FAR)
    for interval in intervals:
        reached = (interval.enter < interval.leave) & (t < interval.leave)
        answer = np.minimum(answer, np.where(reached, np.maximum(t, interval.enter), FAR))
    return answer


def first_outside(intervals: list[Interval], t: Array) -> Array:
    """The first parameter at or after t outside all of them (they are in order)."""
    for interval in intervals:
        t = np.where((interval.enter <= t) & (t < interval.leave), interval.leave, t)
    return t


@dataclass(frozen=True, slots=True)
class _Own:
    """A part's own space at given values of the params: `linear` p + `offset`, the identity where None.

    Primitives of one definition share their formulas, in which `environment` has PARAM nodes; `arguments` are their
    values here. `owner` tells formulas apart.
    """

    owner: int
    environment: Environment
    arguments: dict[str, Array]
    linear: Array | None
    offset: Array
    stretch: float
    grow: float

    def point(self, p: Array) -> Array:
        return p if self.linear is None else _product(self.linear, p) + self.offset

    def direction(self, d: Array) -> Array:
        return d if self.linear is None else _product(self.linear, d)


class Formulas:
    """The formulas of one scene at given values of its params, float64. Points and directions are (3, n)."""

    def __init__(self, graph: FieldGraph, params: Params, materials: Sequence[Material], unpainted: Material) -> None:
        self._graph = graph
        self._params = params
        self._lowering = Lowering()
        self._looks = Looks(self._lowering, materials, unpainted)
        self._evaluators: dict[tuple[str, int], Evaluator] = {}
        self._owns: dict[int, _Own] = {}
        self._p, self._o, self._d = (graph.input(name) for name in "pod")

    def intervals(self, part: Part, o: Array, d: Array, grow: float) -> list[Interval]:
        """The closed-form intervals of the rays with the part, the solid `grow` larger (a length in the scene)."""
        own = self._own(part)

        def roots() -> list[Expr]:
            ray = part.shape.definition.claims.ray
            assert ray is not None
            pairs = ray(self._o, self._d, self._graph.param("grow"), own.environment)
            return [end for pair in pairs for end in pair]

        inputs = {"o": own.point(o), "d": own.direction(d)}
        ends = self._evaluate("ray", own.owner, roots, inputs, {**own.arguments, "grow": np.array(own.grow * grow)})
        ends = [np.broadcast_to(e, o.shape[1:]) for e in ends]
        return [Interval(enter, leave) for enter, leave in zip(ends[::2], ends[1::2], strict=True)]

    def value(self, part: Part, p: Array) -> Array:
        """The part's formula, (n,), in the scene's units."""
        own = self._own(part)
        inputs = {"p": own.point(p)}
        (value,) = self._evaluate("value", own.owner, lambda: [self._formula(part, own)], inputs, own.arguments)
        return np.broadcast_to(value, p.shape[1:]) * own.stretch

    def across(self, part: Part, half: Expr, p: Array, d: Array) -> tuple[Array, Array]:
        """How far points are beyond `half` along the part's own z, and how fast d goes across it, (n,) each."""
        own = self._own(part)
        x, y, _ = own.direction(d)
        return (np.abs(own.point(p)[2]) - self.constant(half)[0]) * own.stretch, np.hypot(x, y) * own.stretch

    def slope(self, part: Part, p: Array, d: Array) -> tuple[Array, Array]:
        """A convex function of the part and its derivative along d, (n,) each."""
        own = self._own(part)

        def roots() -> list[Expr]:
            value = self._sharp(part, own)
            return [value, directional(value, {self._p: self._d})]

        inputs = {"p": own.point(p), "d": own.direction(d)}
        value, along = self._evaluate("slope", own.owner, roots, inputs, own.arguments)
        shape = p.shape[1:]
        return np.broadcast_to(value, shape) * own.stretch, np.broadcast_to(along, shape) * own.stretch

    def parabola(self, part: Part, p: Array, d: Array) -> tuple[Array, Array, Array]:
        """The part's formula, its core (sdfc/facts/bend), and the core's derivative along d, (n,) each."""
        own = self._own(part)

        def roots() -> list[Expr]:
            value = self._formula(part, own)
            core = core_of(part.shape, value)
            return [value, core, directional(core, {self._p: self._d})]

        inputs = {"p": own.point(p), "d": own.direction(d)}
        found = self._evaluate("parabola", own.owner, roots, inputs, own.arguments)
        value, core, along = (np.broadcast_to(a, p.shape[1:]) * own.stretch for a in found)
        return value, core, along

    def span(self, part: Part, p: Array, d: Array, length: Array) -> tuple[Array, Array, Array, Array]:
        """Least and greatest value of the part's formula, and of its slope along d, over pieces of rays, (n,) each."""
        own = self._own(part)

        def roots() -> list[Expr]:
            found = span(self._formula(part, own), self._p, self._d, self._graph.input("s", Type.FLOAT))
            return [*found.value, *found.slope]

        inputs = {"p": own.point(p), "d": own.direction(d), "s": length}
        found = self._evaluate("span", own.owner, roots, inputs, own.arguments)
        low, high, fall, rise = (np.broadcast_to(a, p.shape[1:]) * own.stretch for a in found)
        return low, high, fall, rise

    def bend(self, part: Part, bend: Expr) -> float:
        """The bend of a part's core along the scene's rays, from the one in its own space."""
        own = self._own(part)
        return float(self.constant(bend)[0]) * own.grow * own.grow * own.stretch

    def surface(self, part: Part, p: Array, formula: bool = False) -> Array:
        """Gradient and value, (4, n), of a function whose zero set is the surface; of the formula itself if asked."""
        own = self._own(part)

        def roots() -> list[Expr]:
            value = self._formula(part, own) if formula else self._sharp(part, own)
            return [gradient(value, self._p), value]

        inputs = {"p": own.point(p)}
        normal, value = self._evaluate(f"surface {formula}", own.owner, roots, inputs, own.arguments)
        normal = np.broadcast_to(normal, p.shape)
        if own.linear is not None:
            normal = _product(own.linear.T, normal)
        return np.concatenate([normal, np.broadcast_to(value, (1, p.shape[1]))]) * own.stretch

    def look(self, part: Part, p: Array) -> NDArray[np.int64]:
        """The indices (n,) of the materials that an operation with several shows."""
        own = self._own(part)
        inputs = {"p": own.point(p)}
        (index,) = self._evaluate("look", own.owner, lambda: [self._looks.index(part.shape, self._p)], inputs)
        return np.broadcast_to(index, p.shape[1:]).astype(np.int64)

    def weights(self, blend: Apply, a: Array, b: Array) -> tuple[Array, Array, Array]:
        """A blend's derivatives by its two operands, and its value, (n,) each, for the operands' values."""

        def roots() -> list[Expr]:
            graph = self._graph
            values = [graph.input(name, Type.FLOAT) for name in ("a", "b")]
            names = [parameter.name for parameter in blend.definition.children]
            children = {name: _always(value) for name, value in zip(names, values, strict=True)}
            result = blend.definition.formula(self._p, blend.environment, children)
            one = graph.constant(1.0)
            return [*(directional(result, {value: one}) for value in values), result]

        first, second, value = self._evaluate("weights", blend.id, roots, {"a": a, "b": b})
        return np.broadcast_to(first, a.shape), np.broadcast_to(second, a.shape), np.broadcast_to(value, a.shape)

    def constant(self, value: Expr) -> Array:
        """The components of an expression over params alone."""
        if value.is_constant:
            return np.array(value.numbers)
        return np.ravel(Evaluator([value])({}, self._params)[0])

    def moved(self, matrix: Matrix, o: Array, d: Array) -> tuple[Array, Array]:
        """Origins and directions (3, n) of rays where the matrix maps them."""
        linear, offset = self._numbers(matrix)
        return _product(linear, o) + offset, _product(linear, d)

    def _numbers(self, matrix: Matrix) -> tuple[Array, Array]:
        """Its linear part, (3, 3), and its offset, (3, 1)."""
        linear = np.array([[float(self.constant(e)[0]) for e in row] for row in matrix.linear])
        return linear, np.array([[float(self.constant(e)[0])] for e in matrix.offset])

    def material(self, material: Material) -> Array:
        """Its properties, (13,), in the order of PROPERTIES."""
        return np.concatenate([self.constant(getattr(material, name)) for name in PROPERTIES])

    def call(self, function: Function, arguments: Mapping[str, Array]) -> Array:
        """A shading function over arrays: (n,) for a FLOAT, (k, n) for a VECk; (k, 1) is the same for all points."""
        return self._evaluate(function.name, -1, lambda: [function.result], arguments)[0]

    def _formula(self, part: Part, own: _Own) -> Expr:
        definition = part.shape.definition
        if definition.is_primitive:
            return definition.formula(self._p, own.environment, {})
        return self._lowering.value(part.shape, self._p)

    def _sharp(self, part: Part, own: _Own) -> Expr:
        """The primitive's gauge where there is one: its gradient is sharp at edges, and convex where the solid is."""
        gauge = part.shape.definition.claims.gauge
        if gauge is None or not part.shape.definition.is_primitive:
            return self._formula(part, own)
        return gauge(self._p, own.environment)

    def _own(self, part: Part) -> _Own:
        if id(part) not in self._owns:
            self._owns[id(part)] = self._made(part)
        return self._owns[id(part)]

    def _made(self, part: Part) -> _Own:
        definition, graph = part.shape.definition, self._graph
        owner, environment, arguments = id(part), dict(part.shape.environment), {}
        if definition.is_primitive and all(p.kind in FORMAL for p in definition.values):
            owner = id(definition)
            given = {name: self.constant(a) for name, a in environment.items() if isinstance(a, Expr)}
            arguments = {f"its {name}": value for name, value in given.items()}
            environment = {p.name: graph.param(f"its {p.name}", FORMAL[p.kind]) for p in definition.values}
        linear, offset = None, np.zeros((3, 1))
        if part.inverse is not None:
            linear, offset = self._numbers(part.inverse)
        stretch, grow = (float(self.constant(e)[0]) for e in (part.stretch, part.own_grow))
        return _Own(owner, environment, arguments, linear, offset, stretch, grow)

    def _evaluate(
        self,
        role: str,
        owner: int,
        roots: Callable[[], list[Expr]],
        inputs: Mapping[str, Array],
        arguments: Mapping[str, Array] | None = None,
    ) -> list[Array]:
        key = (role, owner)
        if key not in self._evaluators:
            self._evaluators[key] = Evaluator(roots())
        return self._evaluators[key](inputs, {**self._params, **(arguments or {})})


def _product(matrix: Array, v: Array) -> Array:
    """matrix v, without BLAS: its threads cost more than so small a product, where others use the machine too."""
    rows = [matrix[i, 0] * v[0] + matrix[i, 1] * v[1] + matrix[i, 2] * v[2] for i in range(3)]
    return np.stack(rows)


def _always(value: Expr) -> Callable[[Expr], Expr]:
    """A child that has one value everywhere."""
    return lambda _: value
