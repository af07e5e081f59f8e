"""A shape as one closed expression of the point: what float64, intervals and derivatives read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph
from sdfc.shape.definition import FORMAL
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, Union
from sdfc.shape.stretch import smallest_stretch

FAR = 1e9  # the value of the empty solid: its square is finite in float32 (ALGORITHMS D3)


def combined(operation: Callable[[Expr, Expr], Expr], values: list[Expr]) -> Expr:
    """A chain, in order: Mesa compiles a chain faster than a balanced tree (GL.md 1)."""
    result = values[0]
    for value in values[1:]:
        result = operation(result, value)
    return result


class Lowering:
    """Lowers shapes of one graph; a shape at one point is lowered once."""

    def __init__(self) -> None:
        self._made: dict[tuple[int, int], Expr] = {}

    def value(self, shape: Shape, p: Expr) -> Expr:
        """The value of the shape's field at the point expression `p` (VEC3, or VEC2 in the plane)."""
        key = (shape.id, p.id)
        if key not in self._made:
            self._made[key] = self._value(shape, p)
        return self._made[key]

    def _value(self, shape: Shape, p: Expr) -> Expr:
        graph = p.graph
        match shape:
            case Apply():
                return self._apply(shape, p)
            case Affine():
                stretch = smallest_stretch(shape.forward, shape.dimension)
                return self.value(shape.child, shape.inverse.apply(p)) * stretch
            case Union():
                return combined(graph.min, [self.value(c, p) for c in shape.children])
            case Intersection():
                return combined(graph.max, [self.value(c, p) for c in shape.children])
            case Complement():
                return -self.value(shape.child, p)
            case Paint():
                return self.value(shape.child, p)
            case Nothing():
                return graph.constant(FAR)
            case _:
                assert_never(shape)

    def _apply(self, shape: Apply, p: Expr) -> Expr:
        def at(child: Shape) -> Callable[[Expr], Expr]:
            return lambda q: self.value(child, q)

        names = [parameter.name for parameter in shape.definition.children]
        children = {name: at(child) for name, child in zip(names, shape.children, strict=True)}
        return shape.definition.formula(p, shape.environment, children)


def lower(shape: Shape, p: Expr) -> Expr:
    """The value of `shape` at `p`."""
    return Lowering().value(shape, p)


def generic(shape: Apply, graph: FieldGraph) -> Apply:
    """A primitive as it is printed, once for all of its kind: of inputs that are named as its parameters. Itself where
    lists and counts are part of the formula."""
    values = shape.definition.values
    if not all(p.kind in FORMAL for p in values):
        return shape
    arguments = tuple([graph.input(p.name, FORMAL[p.kind]) for p in values])
    return replace(shape, id=-1 - shape.id, arguments=arguments)  # not a node of the scene


def lower_ray(shape: Apply, o: Expr, d: Expr, grow: Expr) -> tuple[tuple[Expr, Expr], ...]:
    """The closed-form intervals of a primitive along o + t d, in the primitive's own space."""
    ray = shape.definition.claims.ray
    assert ray is not None
    asked = (lower_ray, shape.definition, shape.arguments, o, d, grow)
    return o.graph.remembered(asked, lambda: ray(o, d, grow, shape.environment))


def lower_gauge(shape: Apply, p: Expr) -> Expr:
    """The primitive's gauge at `p`: its zero set is the formula's."""
    gauge = shape.definition.claims.gauge
    return shape.definition.formula(p, shape.environment, {}) if gauge is None else gauge(p, shape.environment)
