"""A `field` declaration as a definition: its parameters, formula and claims as functions that make expressions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.scene import functions
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.formula import (
    NOTHING_OUTSIDE,
    Child,
    Outer,
    Scope,
    Value,
    boolean,
    evaluate,
    expression,
    items,
    scalar,
)
from sdfc.shape.definition import (
    FORMAL,
    Argument,
    ChildFacts,
    Claims,
    Definition,
    Distance,
    Environment,
    Exactness,
    Interval,
    Kind,
    Parameter,
)
from sdfc.syntax import tree
from sdfc.syntax.walk import mentions

_RESERVED = {"p": "the point", "level": "a level", "o": "a ray's origin", "d": "a ray's direction", "grow": "a ray's"}
IN_PLANE = "_in_plane"  # behind the name of an operation on solids: its twin for shapes in the plane
_Found: TypeAlias = Callable[[Environment, Mapping[str, ChildFacts]], Argument]
_ONCE = ("exact", "bound", "convex", "homogeneous", "lipschitz", "bounds", "gauge", "ray", "lowering", "dual")


def define(
    declaration: tree.FieldDeclaration,
    graph: FieldGraph,
    outer: Outer = NOTHING_OUTSIDE,
    is_standard: bool = False,
) -> Definition:
    """The definition that a declaration makes. Raises SceneError for what is wrong without evaluating the formula."""
    kinds = _kinds(declaration)
    maker = _Maker(graph, kinds, outer, declaration)
    parameters = tuple([maker.parameter(p, kinds[p.name.text]) for p in declaration.parameters])
    return Definition(
        name=declaration.name.text,
        doc=declaration.doc,
        dimension=_dimension(declaration.place),
        parameters=parameters,
        formula=maker.at_point(declaration.formula, declaration.where),
        claims=_claims(declaration, maker, is_standard),
        span=declaration.span,
        is_standard=is_standard,
        requirements=tuple([maker.requirement(c) for c in declaration.claims if c.word == "requires"]),
    )


def in_plane(declaration: tree.FieldDeclaration) -> tree.FieldDeclaration:
    """The same operation for shapes in the plane: its formula says the same of them, or cannot be evaluated."""
    parameters = tuple(
        [
            replace(p, kind=tree.Identifier(p.kind.span, "profile")) if p.kind.text == "solid" else p
            for p in declaration.parameters
        ]
    )
    name = tree.Identifier(declaration.name.span, declaration.name.text + IN_PLANE)
    place = tree.Identifier(declaration.name.span, "plane")
    return replace(declaration, name=name, parameters=parameters, place=place)


def _dimension(place: tree.Identifier | None) -> int:
    match place.text if place else "space":
        case "space":
            return 3
        case "plane":
            return 2
    assert place is not None
    raise scene_error(f"a field is in space or in plane, not in '{place.text}'", place.span)


def _kinds(declaration: tree.FieldDeclaration) -> dict[str, Kind]:
    kinds: dict[str, Kind] = {}
    problems: list[Diagnostic] = []
    for parameter in declaration.parameters:
        name, word = parameter.name, parameter.kind.text
        if name.text in kinds:
            problems.append(Diagnostic(f"two parameters are called '{name.text}'", name.span))
        if name.text in _RESERVED:
            what = _RESERVED[name.text]
            problems.append(Diagnostic(f"a parameter cannot be called '{name.text}'", name.span, f"that is {what}"))
        if word not in Kind._value2member_map_:
            hint = did_you_mean(word, [k.value for k in Kind]) or "a kind is " + ", ".join(k.value for k in Kind)
            problems.append(Diagnostic(f"unknown kind '{word}'", parameter.kind.span, hint))
        else:
            kinds[name.text] = Kind(word)
    if problems:
        raise SceneError(*problems)
    return kinds


@dataclass(frozen=True, slots=True)
class _Maker:
    """Turns parts of one declaration into functions of its arguments."""

    graph: FieldGraph
    kinds: Mapping[str, Kind]
    outer: Outer
    declaration: tree.FieldDeclaration

    def scope(
        self,
        environment: Environment,
        where: Sequence[tree.Binding],
        given: Mapping[str, Value] | None = None,
        distances: Mapping[str, Distance] | None = None,
        facts: Mapping[str, ChildFacts] | None = None,
    ) -> Scope:
        """The names for one evaluation: arguments, children, `given`, the formula's own `where` and the claim's."""
        values: dict[str, Value] = dict(environment)
        for name, kind in self.kinds.items():
            if kind.is_child and (distances is not None or facts is not None):
                values[name] = Child(kind, (distances or {}).get(name), (facts or {}).get(name))
        values.update(given or {})
        return Scope(self.graph, values, [*self.declaration.where, *where], self.outer)

    def at_point(
        self, node: tree.Expression, where: Sequence[tree.Binding]
    ) -> Callable[[Expr, Environment, Mapping[str, Distance]], Expr]:
        def formula(p: Expr, environment: Environment, children: Mapping[str, Distance]) -> Expr:
            return scalar(node, self.scope(environment, where, {"p": p}, children))

        return formula

    def gauge(self, claim: tree.Claim) -> Callable[[Expr, Environment], Expr]:
        node = _value(claim)

        def gauge(p: Expr, environment: Environment) -> Expr:
            return scalar(node, self.scope(environment, claim.where, {"p": p}))

        return gauge

    def ray(self, claim: tree.Claim) -> Callable[[Expr, Expr, Expr, Environment], tuple[Interval, ...]]:
        node = _value(claim)

        def ray(o: Expr, d: Expr, grow: Expr, environment: Environment) -> tuple[Interval, ...]:
            given: dict[str, Value] = {"o": o, "d": d, "grow": grow}
            return _intervals(evaluate(node, self.scope(environment, claim.where, given)), node.span)

        return ray

    def lipschitz(self, claim: tree.Claim) -> Callable[[Environment, Mapping[str, ChildFacts]], Expr]:
        node = _value(claim)

        def lipschitz(environment: Environment, facts: Mapping[str, ChildFacts]) -> Expr:
            return scalar(node, self.scope(environment, claim.where, facts=facts))

        return lipschitz

    def bounds(self, claim: tree.Claim) -> Callable[[Environment, Mapping[str, ChildFacts], Expr], Interval]:
        node = _value(claim)
        size = _dimension(self.declaration.place)

        def bounds(environment: Environment, facts: Mapping[str, ChildFacts], level: Expr) -> Interval:
            scope = self.scope(environment, claim.where, {"level": level}, facts=facts)
            if not isinstance(node, tree.Range):
                raise scene_error("bounds are two corners, low..high", node.span)
            low, high = expression(node.low, scope), expression(node.high, scope)
            return _corner(low, size, node.low.span), _corner(high, size, node.high.span)

        return bounds

    def lowering(self, claim: tree.Claim) -> Callable[[Environment], Expr]:
        node = _value(claim)

        def lowering(environment: Environment) -> Expr:
            return scalar(node, self.scope(environment, claim.where))

        return lowering

    def requirement(self, claim: tree.Claim) -> tuple[Callable[[Environment], Expr], str]:
        node = _value(claim)

        def holds(environment: Environment) -> Expr:
            return boolean(node, self.scope(environment, claim.where))

        return holds, claim.detail

    def parameter(self, declared: tree.FieldParameter, kind: Kind) -> Parameter:
        limits = {limit.operator: self._limit(limit) for limit in declared.limits}
        for limit in declared.limits:
            if limit.operator in ("==", "!="):
                raise scene_error(f"'{limit.operator}' is no limit", limit.span, "use < <= > or >=")
        if kind.is_child and (limits or declared.default is not None):
            raise scene_error("a shape has no limits and no default", declared.span)
        found = self._found(declared, kind)
        return Parameter(
            name=declared.name.text,
            kind=kind,
            default=None if declared.default is None else self._default(declared.default, kind, found),
            found=found,
            minimum=limits.get(">", limits.get(">=")),
            above=">" in limits,
            maximum=limits.get("<", limits.get("<=")),
            below="<" in limits,
        )

    def _limit(self, limit: tree.Limit) -> float:
        value = scalar(limit.value, Scope(self.graph, {}))
        if not value.is_constant or math.isnan(value.number):
            raise scene_error("a limit must be a number", limit.value.span)
        return value.number

    def _default(self, node: tree.Expression, kind: Kind, found: _Found | None) -> Callable[[Environment], Argument]:
        def default(environment: Environment) -> Argument:
            if found is not None:
                return found(environment, self._endless())
            return conform(evaluate(node, self.scope(environment, ())), kind, node.span)

        return default

    def _found(self, declared: tree.FieldParameter, kind: Kind) -> _Found | None:
        """The default as a function of the children's facts, where it asks for any."""
        node = declared.default
        children = [name for name, kind in self.kinds.items() if kind.is_child]
        if node is None or not children or mentions(node).used.isdisjoint(children):
            return None
        if declared.limits:
            raise scene_error("what is found from a shape has no limits", declared.span)

        def found(environment: Environment, facts: Mapping[str, ChildFacts]) -> Argument:
            return conform(evaluate(node, self.scope(environment, (), facts=facts)), kind, node.span)

        return found

    def _endless(self) -> dict[str, ChildFacts]:
        """Facts of children of which nothing is known."""
        sizes = {name: 2 if kind is Kind.PROFILE else 3 for name, kind in self.kinds.items() if kind.is_child}
        ends = {name: self.graph.constant(*[math.inf] * size) for name, size in sizes.items()}
        return {name: ChildFacts(-end, end, self.graph.constant(1.0)) for name, end in ends.items()}


def _value(claim: tree.Claim) -> tree.Expression:
    assert claim.value is not None  # the grammar gives one to each claim that has a formula
    return claim.value


def _corner(value: Expr, size: int, span: Span) -> Expr:
    if value.type not in (Type.FLOAT, Type(size)):
        raise scene_error(f"a corner is a vector of {size}, not {functions.type_words(value.type)}", span)
    return functions.spread(value, size)


def _intervals(value: Value, span: Span) -> tuple[Interval, ...]:
    """`[enter, exit]`, or a list of such pairs."""
    pairs = value if isinstance(value, tuple) else (value,)
    intervals: list[Interval] = []
    for pair in pairs:
        if not isinstance(pair, Expr) or pair.type is not Type.VEC2:
            raise scene_error("a ray's interval is [enter, exit], or a list of those", span)
        intervals.append((pair[0], pair[1]))
    return tuple(intervals)


_TYPES = {**FORMAL, Kind.COUNT: Type.FLOAT, Kind.BOOLEAN: Type.BOOL}
_ELEMENTS = {Kind.NUMBERS: Type.FLOAT, Kind.POINTS2: Type.VEC2, Kind.POINTS3: Type.VEC3}


def type_of(kind: Kind) -> Type:
    """The type of a value of that kind (of one element, for a list)."""
    return _ELEMENTS[kind] if kind.is_list else _TYPES[kind]


def conform(value: Value, kind: Kind, span: Span) -> Argument:
    """The value as a parameter of that kind takes it; a number is spread where a vector is wanted."""
    wanted = type_of(kind)
    if kind.is_list:
        elements: list[Expr] = []
        for element in items(value, span):
            if not isinstance(element, Expr) or element.type is not wanted:
                raise scene_error(f"expected a list, each element {functions.type_words(wanted)}", span)
            elements.append(element)
        return tuple(elements)
    if not isinstance(value, Expr):
        raise scene_error(f"expected {functions.type_words(wanted)}", span)
    if value.type is Type.FLOAT and wanted in (Type.VEC2, Type.VEC3):
        return functions.spread(value, wanted.size)
    if value.type is not wanted:
        raise scene_error(f"expected {functions.type_words(wanted)}, not {functions.type_words(value.type)}", span)
    return value


# --- claims


def _claims(declaration: tree.FieldDeclaration, maker: _Maker, is_standard: bool) -> Claims:
    found: dict[str, tree.Claim] = {}
    for claim in declaration.claims:
        if claim.word in _ONCE and claim.word in found:
            raise scene_error(f"'{claim.word}' is claimed twice", claim.span)
        found[claim.word] = claim
    if "exact" in found and "bound" in found:
        raise scene_error("a field is either exact or a bound", found["bound"].span)
    bounds = found.get("bounds")
    return Claims(
        exactness=_exactness(found),
        convex="convex" in found,
        homogeneous="homogeneous" in found,
        lipschitz=_lipschitz(found, maker, is_standard),
        bounds=maker.bounds(bounds) if bounds else None,
        bounds_use_level=bounds is not None and "level" in mentions((bounds.value, bounds.where)).used,
        gauge=maker.gauge(found["gauge"]) if "gauge" in found else None,
        ray=maker.ray(found["ray"]) if "ray" in found else None,
        ray_is_dear="ray" in found and found["ray"].detail == "dear",
        lowering=maker.lowering(found["lowering"]) if "lowering" in found else None,
        dual=_dual(found.get("dual"), declaration),
    )


def _dual(claim: tree.Claim | None, declaration: tree.FieldDeclaration) -> str | None:
    if claim is None:
        return None
    return claim.detail + (IN_PLANE if declaration.name.text.endswith(IN_PLANE) else "")


def _exactness(found: Mapping[str, tree.Claim]) -> Exactness:
    if "exact" in found:
        return Exactness(" ".join(["exact", found["exact"].detail]).strip())
    return Exactness.BOUND if "bound" in found else Exactness.NONE


def _lipschitz(
    found: Mapping[str, tree.Claim], maker: _Maker, is_standard: bool
) -> Callable[[Environment, Mapping[str, ChildFacts]], Expr] | None:
    """As claimed; else 1 for what is a distance or a bound of it, and for an operation its children's greatest."""
    if "lipschitz" in found:
        return maker.lipschitz(found["lipschitz"])
    is_operation = any(kind.is_child for kind in maker.kinds.values())
    if "exact" not in found and "bound" not in found and not (is_operation and is_standard):
        return None

    def default(environment: Environment, facts: Mapping[str, ChildFacts]) -> Expr:
        result: Expr | None = None
        for child in facts.values():
            result = child.lipschitz if result is None else maker.graph.max(result, child.lipschitz)
        return maker.graph.constant(1.0) if result is None else result

    return default
