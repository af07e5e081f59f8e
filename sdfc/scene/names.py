"""Which value a name has, and where: in an expression, its function, its file."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

from sdfc.diagnostics import Diagnostic, InternalError, SceneError, Span, scene_error
from sdfc.field.graph import FieldGraph
from sdfc.scene.functions import CONSTANTS
from sdfc.scene.library import Library
from sdfc.scene.limits import MOST_PROBLEMS, Budget, LimitError
from sdfc.scene.model import Param
from sdfc.scene.values import Quantity, Value
from sdfc.shape.definition import Definition
from sdfc.shape.graph import ShapeGraph
from sdfc.syntax import tree


class Tables(Protocol):
    """Reads the files that a scene names."""

    def read(self, path: str, span: Span) -> Any: ...


@dataclass(slots=True)
class Context:
    """What all parts of one elaboration share."""

    graph: FieldGraph
    shapes: ShapeGraph
    library: Library
    rules: Mapping[type, Rule]
    budget: Budget = field(default_factory=Budget)
    params: dict[str, Param] = field(default_factory=dict)
    warnings: list[Diagnostic] = field(default_factory=list)
    tried: set[tuple[object, ...]] = field(default_factory=set)  # formulas, with what their loops depend on


class Module(Protocol):
    """One file's declarations, as expressions in it see them."""

    def value(self, name: str, span: Span) -> Value | None:
        """A param, a material or a constant."""

    def function(self, name: str) -> tuple[tree.FunctionDeclaration, Module] | None:
        """A `def` with parameters, and where it was written."""

    def definition(self, name: str) -> Definition | None:
        """A `field`."""

    def names(self) -> Sequence[str]:
        """All that is visible."""

    def table(self, path: str, span: Span) -> Sequence[Value]:
        """The rows of a CSV beside this file."""


Rule: TypeAlias = "Callable[[Any, Names], Value]"


class Names:
    """The names visible at one place of an expression."""

    __slots__ = ("bindings", "calls", "context", "module", "open", "parent", "values")

    def __init__(
        self,
        context: Context,
        module: Module,
        values: Mapping[str, Value] | None = None,
        bindings: Sequence[tree.Binding] = (),
        parent: Names | None = None,
        calls: tuple[str, ...] = (),
    ) -> None:
        self.context = context
        self.module = module
        self.values: dict[str, Value] = dict(values or {})
        self.bindings = {b.name.text: b for b in bindings}
        self.open: set[str] = set()
        self.parent = parent
        self.calls = calls  # the functions that are being expanded, outermost first

    def within(self, name: str, value: Value) -> Names:
        """The same names and one more: a loop's variable, a row."""
        return Names(self.context, self.module, {name: value}, (), self, self.calls)

    def local(self, name: str, span: Span) -> Value | None:
        """The value of an argument, a loop's variable or a name after `where`."""
        scope: Names | None = self
        while scope is not None:
            if name in scope.values:
                return scope.values[name]
            if name in scope.bindings:
                return scope._bound(scope.bindings[name], span)
            scope = scope.parent
        return None

    def find(self, name: str, span: Span) -> Value:
        """The value of a name. Raises SceneError for one that there is not."""
        value = self.local(name, span) or self.module.value(name, span)
        if value is not None:
            return value
        graph = self.context.graph
        if name in CONSTANTS:
            return Quantity(graph.constant(CONSTANTS[name]))
        if name in ("true", "false"):
            return Quantity(graph.boolean(name == "true"))
        if name == "nothing":
            return self.context.shapes.nothing(span)
        if name == "row":
            raise scene_error("'row' is known only inside instances(…)", span)
        if self.context.library.definition(name) is not None:
            raise scene_error(f"'{name}' needs its parentheses", span, f"write {name}(…)")
        raise scene_error(f"unknown name '{name}'", span, did_you_mean(name, self.known()))

    def known(self) -> list[str]:
        """Every name that has a value here."""
        names = [*self.module.names(), *CONSTANTS, "true", "false", "nothing"]
        scope: Names | None = self
        while scope is not None:
            names += [*scope.values, *scope.bindings]
            scope = scope.parent
        return names

    def _bound(self, binding: tree.Binding, span: Span) -> Value:
        name = binding.name.text
        if name in self.open:
            raise scene_error(f"'{name}' is defined by itself", span)
        self.open.add(name)
        value = self.values[name] = evaluate(binding.value, self)
        self.open.discard(name)
        return value


def evaluate(node: tree.Expression, names: Names) -> Value:
    """The value of an expression."""
    rule = names.context.rules.get(type(node))
    if rule is None:
        raise InternalError(f"no rule for {type(node).__name__} in a scene")
    return rule(node, names)


def did_you_mean(name: str, known: Sequence[str]) -> str | None:
    """A hint with the nearest known name, if there is one near."""
    close = difflib.get_close_matches(name, sorted(set(known)), n=1)
    return f"did you mean '{close[0]}'?" if close else None


class Problems:
    """Errors gathered so that several are told at once; each place and message once. Too many end the search."""

    __slots__ = ("found",)

    def __init__(self) -> None:
        self.found: dict[tuple[object, ...], Diagnostic] = {}

    def add(self, *diagnostics: Diagnostic) -> None:
        for diagnostic in diagnostics:
            span = diagnostic.span
            place = None if span is None else (span.source.name, span.start, span.end)
            self.found.setdefault((place, diagnostic.message), diagnostic)
        if len(self.found) >= MOST_PROBLEMS:
            self.finish()

    def take(self, error: SceneError) -> None:
        """Keeps the errors, to be told with others. A limit that was passed ends everything at once."""
        if isinstance(error, LimitError):
            raise error
        self.add(*error.diagnostics)

    def attempt(self, action: Callable[[], Value]) -> Value | None:
        """The action's value, or None and its errors kept."""
        try:
            return action()
        except SceneError as error:
            self.take(error)
            return None

    def finish(self) -> None:
        """Raises what was gathered."""
        if self.found:
            raise SceneError(*self.found.values())
