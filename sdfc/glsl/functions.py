"""The GLSL functions of definitions: for each, only the meanings that a scene asks for."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias, assert_never

from sdfc.facts.bend import core_of
from sdfc.field.derivative import directional, gradient
from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.span import span
from sdfc.glsl.expression import LOCAL_WORDS, Printed, printed
from sdfc.glsl.names import LOCALS, Names, param_name
from sdfc.plan.steps import Part
from sdfc.shape.definition import FORMAL, Argument, Definition, Kind
from sdfc.shape.graph import Apply
from sdfc.shape.look import Looks
from sdfc.shape.lower import FAR, Lowering, generic, lower_gauge

_Formal: TypeAlias = tuple[tuple[str, Type], ...]
_POINT: _Formal = (("p", Type.VEC3),)
_POINT_AND_WAY: _Formal = (("p", Type.VEC3), ("d", Type.VEC3))
_RAY: _Formal = (("o", Type.VEC3), ("d", Type.VEC3), ("grow", Type.FLOAT))

AHEAD = "ray length"  # of the piece of the ray: no name that a parameter of a field can have


class Role(Enum):
    """What a function says of a definition; the value is the suffix of its name."""

    VALUE = ""  # float: the formula
    RAY = "_ray"  # vec2, or vec4 for two: sorted intervals, empty ones as (FAR, -FAR)
    SLOPE = "_slope"  # vec2: a convex function and its derivative along d
    DISTANCE_SLOPE = "_distance_slope"  # vec2: the formula and its derivative along d
    SURFACE = "_surface"  # vec4: gradient and value of a function with the surface as its zero set
    DISTANCE_SURFACE = "_distance_surface"  # vec4: gradient and value of the formula
    SPAN = "_span"  # vec4: bounds of the formula, and of its slope along d, over a piece of the ray
    PARABOLA = "_parabola"  # vec3: the formula; its core, and the core's derivative along d
    LOOK = "_look"  # float: the index of the material of an operation with several
    JOINED = "_of"  # float: a blend of two values
    WEIGHTS = "_weights"  # vec3: a blend's derivatives by its two operands, and its value


@dataclass(frozen=True, slots=True)
class Call:
    """A function's name and the arguments that follow the point (and direction, and growth)."""

    name: str
    arguments: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class GlslFunction:
    """A function of the shader: what it is called, what is said of it, and what it does."""

    name: str
    doc: str
    printed: Printed

    @property
    def text(self) -> str:
        return self.printed.text(self.name, self.doc)


# Of the standard library, by definition and role: no more than there are, and the same in every scene.
_STANDARD: dict[tuple[str, Role], Printed] = {}


class Functions:
    """Collects functions as calls are asked for; equal ones are one."""

    def __init__(self, graph: FieldGraph, lowering: Lowering, looks: Looks, taken: Iterable[str] = ()) -> None:
        self._graph = graph
        self._lowering = lowering
        self._looks = looks
        self._by_key: dict[tuple[int, Role], GlslFunction] = {}
        self._formals: dict[int, _Formal | None] = {}
        self.names = Names((*LOCALS, *(param_name(n) for n in taken)))

    @property
    def all(self) -> tuple[GlslFunction, ...]:
        return tuple(self._by_key.values())

    def of_part(self, part: Part, role: Role) -> Call:
        """The call that gives the part's `role` in the part's own space."""
        return self.of_shape(part.shape, role, part.name)

    def of_shape(self, shape: Apply, role: Role, name: str) -> Call:
        definition = shape.definition
        formal = self._formal(definition)
        if formal is None:  # lists, counts and children are part of the formula: a function for this one alone
            key = shape.id, role
            if key not in self._by_key:
                own = self._made(shape, role, ())
                self._by_key[key] = GlslFunction(self._fresh(name + role.value), _doc(definition, role), printed(own))
            return Call(self._by_key[key].name, ())
        key = id(definition), role
        if key not in self._by_key:
            made = self._printed(definition, role, lambda: self._made(generic(shape, self._graph), role, formal))
            self._by_key[key] = GlslFunction(self._fresh(definition.name + role.value), _doc(definition, role), made)
        return Call(self._by_key[key].name, _numbers(shape))

    def joined(self, blend: Apply) -> Call:
        """A blend as a function of its operands' values `a` and `b`."""
        return self._blend(blend, Role.JOINED)

    def weights(self, blend: Apply) -> Call:
        """A blend's derivatives by `a` and `b`, and its value, as a function of `a` and `b`."""
        return self._blend(blend, Role.WEIGHTS)

    def _formal(self, definition: Definition) -> _Formal | None:
        """The parameters of functions that all shapes of a definition share; None where each has its own."""
        key = id(definition)
        if key not in self._formals:
            values = definition.values
            is_shared = definition.is_primitive and all(p.kind in FORMAL for p in values)
            self._formals[key] = tuple((p.name, FORMAL[p.kind]) for p in values) if is_shared else None
        return self._formals[key]

    def _printed(self, definition: Definition, role: Role, make: Callable[[], Function]) -> Printed:
        """A function of a definition alone; those of the standard library are made once."""
        if not definition.is_standard or role is Role.LOOK:  # the scene's materials are numbered
            return printed(make())
        key = definition.name, role
        if key not in _STANDARD:
            _STANDARD[key] = printed(make())
        return _STANDARD[key]

    def _blend(self, blend: Apply, role: Role) -> Call:
        definition = blend.definition
        key = (id(definition), role)
        if key not in self._by_key:
            made = self._printed(definition, role, lambda: self._of_operands(definition, role))
            self._by_key[key] = GlslFunction(self._fresh(definition.name + role.value), definition.doc, made)
        return Call(self._by_key[key].name, _numbers(blend))

    def _of_operands(self, definition: Definition, role: Role) -> Function:
        environment: dict[str, Argument] = {p.name: self._input(p.name, p.kind) for p in definition.values}
        a, b = self._graph.input("a", Type.FLOAT), self._graph.input("b", Type.FLOAT)
        first, second = definition.children
        children = {first.name: lambda _: a, second.name: lambda _: b}
        result = definition.formula(self._graph.input("p"), environment, children)
        if role is Role.WEIGHTS:
            one = self._graph.constant(1.0)
            slopes = [directional(result, {a: one}), directional(result, {b: one})]
            result = self._graph.vector(*slopes, result)
        formal = (("a", Type.FLOAT), ("b", Type.FLOAT), *((p.name, FORMAL[p.kind]) for p in definition.values))
        return Function(definition.name + role.value, formal, result)

    def _fresh(self, wanted: str) -> str:
        """A name for a function: never one like those that generated variables have (box_1, s2, ratio)."""
        is_like_local = wanted in LOCAL_WORDS or re.search(r"_\d+$|^s\d+$", wanted)
        return self.names.fresh(f"{wanted}_field" if is_like_local else wanted)

    def _input(self, name: str, kind: Kind) -> Expr:
        return self._graph.input(name, FORMAL[kind])

    def _made(self, shape: Apply, role: Role, formal: _Formal) -> Function:
        result, leading = self._meaning(shape, role)
        return Function(shape.definition.name + role.value, (*leading, *formal), result)

    def _meaning(self, shape: Apply, role: Role) -> tuple[Expr, _Formal]:
        """What a role says of a shape, and of what besides the shape's own parameters."""
        graph = self._graph
        p, o, d = graph.input("p"), graph.input("o"), graph.input("d")
        match role:
            case Role.VALUE:
                return self._lowering.value(shape, p), _POINT
            case Role.RAY:
                return intervals(shape, o, d, graph.input("grow", Type.FLOAT)), _RAY
            case Role.LOOK:
                return self._looks.index(shape, p), _POINT
            case Role.SLOPE | Role.DISTANCE_SLOPE:
                value = self._function_of(shape, p, role is Role.DISTANCE_SLOPE)
                return graph.vector(value, directional(value, {p: d})), _POINT_AND_WAY
            case Role.SURFACE | Role.DISTANCE_SURFACE:
                value = self._function_of(shape, p, role is Role.DISTANCE_SURFACE)
                normal = gradient(value, p)
                return graph.vector(normal[0], normal[1], normal[2], value), _POINT
            case Role.SPAN:
                ahead = graph.input(AHEAD, Type.FLOAT)
                result = span(self._lowering.value(shape, p), p, d, ahead).vector
                return result, (*_POINT_AND_WAY, (AHEAD, Type.FLOAT))
            case Role.PARABOLA:
                value = self._lowering.value(shape, p)
                core = core_of(shape, value)
                return graph.vector(value, core, directional(core, {p: d})), _POINT_AND_WAY
            case Role.WEIGHTS | Role.JOINED:
                raise AssertionError("a blend's functions are of its operands' values, not of a point")
            case _:
                assert_never(role)

    def _function_of(self, shape: Apply, p: Expr, is_distance: bool) -> Expr:
        return self._lowering.value(shape, p) if is_distance else self.convex_function(shape, p)

    def convex_function(self, shape: Apply, p: Expr) -> Expr:
        """The primitive's gauge (sharp, and convex where the solid is), else the formula."""
        return lower_gauge(shape, p) if shape.definition.is_primitive else self._lowering.value(shape, p)


def _doc(definition: Definition, role: Role) -> str:
    return "which material is seen" if role is Role.LOOK else definition.doc


def _numbers(shape: Apply) -> tuple[Expr, ...]:
    """The arguments that a call hands on."""
    return tuple([a for a in shape.arguments if isinstance(a, Expr)])


def intervals(shape: Apply, o: Expr, d: Expr, grow: Expr) -> Expr:
    """A primitive's intervals as one vector; an empty one is (FAR, -FAR), so that one comparison with its end tells."""
    assert shape.definition.claims.ray is not None
    graph = o.graph
    ends: list[Expr] = []
    for enter, leave in shape.definition.claims.ray(o, d, grow, shape.environment):
        ends += [enter, graph.select(enter < leave, leave, -FAR)]
    return graph.vector(*ends)
