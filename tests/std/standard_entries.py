"""Entries of the standard library with drawn arguments: what the tests of this folder are about."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import reject
from hypothesis import strategies as st
from numpy.typing import NDArray

from sdfc.diagnostics import SceneError
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.scene.define import IN_PLANE, type_of
from sdfc.scene.library import Library, standard_names
from sdfc.shape.definition import Argument, ChildFacts, Definition, Exactness, Kind, Parameter

Array = NDArray[np.float64]


def _definitions() -> dict[str, Definition]:
    """Every standard field, and of every operation on solids its twin in the plane, where it makes sense there."""
    graph = FieldGraph()
    library = Library(graph)
    found = {}
    for name in standard_names():
        definition = library.definition(name)
        assert definition is not None
        found[name] = definition
        if definition.dimension == 3 and any(p.kind is Kind.SOLID for p in definition.children):
            with suppress(SceneError):  # its formula makes sense in space only
                twin = library.definition(name + IN_PLANE)
                assert twin is not None
                numbers = {p.name: p.default({}) for p in twin.values if p.default}
                twin.formula(graph.input("p", Type.VEC2), numbers, {p.name: graph.length for p in twin.children})
                found[name + IN_PLANE] = twin
    return found


_DEFINITIONS = _definitions()
NAMES = list(_DEFINITIONS)


def names_where(condition: Callable[[Definition], bool]) -> list[str]:
    """The standard names whose definition is such."""
    return [name for name, definition in _DEFINITIONS.items() if condition(definition)]


@dataclass(frozen=True, slots=True)
class Child:
    """A shape to operate on, with its facts; `box(level)` holds {distance <= level}."""

    words: str
    distance: Callable[[Expr], Expr]
    box: Callable[[float], tuple[Array, Array]]
    exactness: Exactness
    convex: bool
    lipschitz: float


@dataclass(frozen=True, slots=True)
class Subject:
    """A standard entry with arguments."""

    definition: Definition
    graph: FieldGraph
    arguments: Mapping[str, Argument]
    children: Mapping[str, Child]

    def __repr__(self) -> str:
        values = {n: a.numbers if isinstance(a, Expr) else [e.numbers for e in a] for n, a in self.arguments.items()}
        return f"{self.definition.name}({values}, {[c.words for c in self.children.values()]})"

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        printer.text(repr(self))  # what hypothesis shows

    @property
    def point(self) -> Expr:
        return self.graph.input("p", Type(self.definition.dimension))

    @property
    def formula(self) -> Expr:
        distances = {name: child.distance for name, child in self.children.items()}
        return self.definition.formula(self.point, self.arguments, distances)

    @property
    def gauge(self) -> Expr:
        gauge = self.definition.claims.gauge
        return gauge(self.point, self.arguments) if gauge else self.formula

    def facts(self, level: float = 0.0) -> dict[str, ChildFacts]:
        return _facts(self.graph, self.children, level)

    @property
    def lipschitz(self) -> float:
        claim = self.definition.claims.lipschitz
        assert claim is not None, "every standard field has a Lipschitz constant"
        return claim(self.arguments, self.facts()).number

    @property
    def lowering(self) -> float:
        claim = self.definition.claims.lowering
        return claim(self.arguments).number if claim else 0.0

    @property
    def exactness(self) -> Exactness:
        """The class with these children, all of them exact or exact outside."""
        claimed = self.definition.claims.exactness
        least = {c.exactness for c in self.children.values()}
        if Exactness.NONE in least:
            return Exactness.NONE
        if claimed is Exactness.EXACT and Exactness.EXACT_OUTSIDE in least:
            return Exactness.EXACT_OUTSIDE
        return claimed

    def bounds(self, level: float = 0.0) -> tuple[Array, Array]:
        """The box of {formula <= level}: as claimed, or widened where the claim is for level 0 and the field exact."""
        claims = self.definition.claims
        assert claims.bounds is not None, "every standard field has bounds"
        lo, hi = claims.bounds(self.arguments, self.facts(level + self.lowering), self.graph.constant(level))
        widen = 0.0 if claims.bounds_use_level or self.children else level
        return np.array(lo.numbers) - widen, np.array(hi.numbers) + widen

    @property
    def scale(self) -> float:
        """About how large it is."""
        lo, hi = self.bounds()
        sizes = np.abs(np.concatenate([lo, hi]))
        return float(max(sizes[np.isfinite(sizes)], default=1.0)) + 0.1

    def points(self, generator: np.random.Generator, count: int, spread: float = 1.4) -> Array:
        """Random points in and around it, (k, count)."""
        lo, hi = self.bounds()
        size = self.scale
        lo = np.where(np.isfinite(lo), lo, -size)
        hi = np.where(np.isfinite(hi), hi, size)
        middle, half = (lo + hi) / 2, np.maximum(np.abs(hi - lo) / 2, 0.02 * size)
        return middle[:, None] + spread * half[:, None] * generator.uniform(-1, 1, (len(lo), count))

    def value(self, points: Array, root: Expr | None = None) -> Array:
        """The formula (or `root`) at the points, (count,)."""
        (value,) = Evaluator([self.formula if root is None else root])({"p": points})
        return np.broadcast_to(value, points.shape[-1:])

    def surface(self, generator: np.random.Generator, count: int = 3000, root: Expr | None = None) -> Array:
        """Points on the surface, by bisection between random points inside and outside; there may be none."""
        points = self.points(generator, count, 1.1)
        value = self.value(points, root)
        inside, outside = points[:, value < 0], points[:, value > 0]
        if inside.shape[1] == 0 or outside.shape[1] == 0:
            return np.zeros((len(points), 0))
        a = inside[:, generator.integers(0, inside.shape[1], count)]
        b = outside[:, generator.integers(0, outside.shape[1], count)]
        evaluator = Evaluator([self.formula if root is None else root])
        for _ in range(42):
            middle = (a + b) / 2
            within = evaluator({"p": middle})[0] < 0
            a, b = np.where(within, middle, a), np.where(within, b, middle)
        return (a + b) / 2


def _facts(graph: FieldGraph, children: Mapping[str, Child], level: float = 0.0) -> dict[str, ChildFacts]:
    boxes = {name: child.box(level) for name, child in children.items()}
    return {
        name: ChildFacts(
            graph.constant(*boxes[name][0]), graph.constant(*boxes[name][1]), graph.constant(child.lipschitz)
        )
        for name, child in children.items()
    }


# --- arguments

_LISTS = {Kind.NUMBERS: 1, Kind.POINTS2: 2, Kind.POINTS3: 3}
_SIZES = {Kind.VECTOR2: 2, Kind.VECTOR3: 3, Kind.POINT2: 2, Kind.POINT3: 3}


def _component(parameter: Parameter) -> st.SearchStrategy[float]:
    """One number within the parameter's limits; awkward ones among them."""
    low, high = parameter.minimum, parameter.maximum
    if parameter.kind is Kind.COUNT:
        least = round(low or 1) + (1 if parameter.above else 0)
        return st.integers(least, min(round(high) if high else least + 5, least + 9)).map(float)
    if parameter.kind is Kind.ANGLE and low is not None and high is not None:
        return st.floats(low + 0.02, high - 0.02)
    if high is not None:
        return st.floats(low if low is not None else -high, high)
    if low is None:
        return st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(-1.5, 1.5))
    usual = st.floats(low + 0.05, low + 2.0)
    awkward = st.sampled_from([low + 1e-3, low + 5.0] if parameter.above else [low, low + 1e-3, low + 5.0])
    return st.one_of(usual, usual, usual, awkward)


# what a random vector hardly ever is: whole, 0 or 1
_WHOLE = {("repeat", "count"), ("repeat_profile", "count")}


@st.composite
def _argument(draw: st.DrawFn, name: str, parameter: Parameter, graph: FieldGraph, elements: int) -> Argument:
    component = _component(parameter)
    if (name, parameter.name) in _WHOLE:
        component = st.integers(0, 4).map(float)
    kind = parameter.kind
    if kind.is_list:
        number = st.floats(-1.0, 1.0)
        if name == "convex_polyhedron" and kind is Kind.NUMBERS:
            number = st.floats(0.1, 1.0)
        width = _LISTS[kind]
        return tuple(
            graph.constant(
                *draw(st.lists(number, min_size=width, max_size=width).filter(lambda v: math.hypot(*v) > 1e-2))
            )
            for _ in range(elements)
        )
    if kind is Kind.BOOLEAN:
        return graph.boolean(draw(st.booleans()))
    width = _SIZES.get(kind, 1)
    made = graph.constant(*[draw(component) for _ in range(width)])
    assert made.type is type_of(kind)
    return made


@st.composite
def subjects(draw: st.DrawFn, name: str, kinds: str = "any", is_fenced: bool = False) -> Subject:
    """The standard entry with drawn arguments that meet its requirements, and drawn children.

    What it finds of them is told it, always where `is_fenced`; otherwise it may be as if they had no end.
    """
    graph = FieldGraph()
    definition = Library(graph).definition(name)
    assert definition is not None
    for _ in range(60):
        elements = draw(st.sampled_from([3, 4, 5, 6])) if name != "heightfield" else draw(st.sampled_from([4, 6, 12]))
        arguments = {p.name: draw(_argument(name, p, graph, elements)) for p in definition.values if not p.found}
        if all(holds(arguments).numbers[0] for holds, _ in definition.requirements):
            break
    else:
        reject()
    children = {p.name: draw(_children(p.kind, graph, kinds)) for p in definition.children}
    facts = _facts(graph, children)
    is_known = True if is_fenced else draw(st.booleans())
    for p in definition.values:
        if p.found is not None and p.default is not None:
            arguments[p.name] = p.found(arguments, facts) if is_known else p.default(arguments)
    return Subject(definition, graph, arguments, children)


def default_subject(name: str) -> Subject:
    """The entry with its defaults, on a ball or a disc."""
    graph = FieldGraph()
    definition = Library(graph).definition(name)
    assert definition is not None
    arguments: dict[str, Argument] = {}
    children = {p.name: _ball(graph, np.zeros(2 if p.kind is Kind.PROFILE else 3), 0.4) for p in definition.children}
    facts = _facts(graph, children)
    for parameter in definition.values:
        assert parameter.default is not None, f"{name}: {parameter.name} has no default"
        found = parameter.found
        arguments[parameter.name] = found(arguments, facts) if found else parameter.default(arguments)
    return Subject(definition, graph, arguments, children)


# --- children


def _widened(lo: Array, hi: Array) -> Callable[[float], tuple[Array, Array]]:
    return lambda level: (lo - level, hi + level)


def _ball(graph: FieldGraph, center: Array, radius: float) -> Child:
    at = graph.constant(*center)
    box = _widened(center - radius, center + radius)
    words = f"ball of {radius} at {center.tolist()}"
    return Child(words, lambda p: graph.length(p - at) - radius, box, Exactness.EXACT, True, 1.0)


def _box(graph: FieldGraph, center: Array, half: Array) -> Child:
    def distance(p: Expr) -> Expr:
        w = graph.abs(p - graph.constant(*center)) - graph.constant(*half)
        largest = w[0]
        for i in range(1, len(center)):
            largest = graph.max(largest, w[i])
        return graph.length(graph.max(w, 0.0)) + graph.min(largest, 0.0)

    box = _widened(center - half, center + half)
    return Child(f"box of {half.tolist()} at {center.tolist()}", distance, box, Exactness.EXACT, True, 1.0)


def _both(graph: FieldGraph, a: Child, b: Child) -> Child:
    def box(level: float) -> tuple[Array, Array]:
        return np.minimum(a.box(level)[0], b.box(level)[0]), np.maximum(a.box(level)[1], b.box(level)[1])

    def distance(p: Expr) -> Expr:
        return graph.min(a.distance(p), b.distance(p))

    return Child(f"{a.words} | {b.words}", distance, box, Exactness.EXACT_OUTSIDE, False, 1.0)


def _steep(a: Child, slope: float) -> Child:
    """Times a slope: no distance, but of a known Lipschitz constant."""
    return Child(
        f"{slope} * {a.words}",
        lambda p: a.distance(p) * slope,
        lambda level: a.box(level / slope),
        Exactness.NONE,
        a.convex,
        slope,
    )


@st.composite
def _children(draw: st.DrawFn, kind: Kind, graph: FieldGraph, kinds: str) -> Child:
    size = 2 if kind is Kind.PROFILE else 3
    position = st.lists(st.floats(-0.7, 0.7), min_size=size, max_size=size).map(np.array)
    extent = st.floats(0.1, 0.8)

    def simple() -> Child:
        if draw(st.booleans()):
            return _ball(graph, draw(position), draw(extent))
        return _box(graph, draw(position), np.array([draw(extent) for _ in range(size)]))

    words = {"any": ["simple", "both", "steep"], "distance": ["simple", "both"], "convex": ["simple"]}[kinds]
    match draw(st.sampled_from(words)):
        case "simple":
            return simple()
        case "both":
            return _both(graph, simple(), simple())
        case _:
            return _steep(simple(), draw(st.sampled_from([0.5, 2.0])))
