"""Which value a name has, and where: in an expression, its function, its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Protocol, TypeAlias

from sdfc.diagnostics import Diagnostic, InternalError, SceneError, Span, scene_error
from sdfc.field.graph import FieldGraph
from sdfc.scene.bindings import Bindings, did_you_mean
from sdfc.scene.functions import CONSTANTS
from sdfc.scene.library import Library
from sdfc.scene.limits import MOST_PROBLEMS, Budget, LimitError
from sdfc.scene.literals import NO_LITERALS, Literals
from sdfc.scene.model import Param
from sdfc.scene.values import Quantity, Value
from sdfc.shape.definition import Definition
from sdfc.shape.graph import ShapeGraph
from sdfc.syntax import tree


@dataclass(slots=True)
class Context:
    """What all parts of one elaboration share."""

    graph: FieldGraph
    shapes: ShapeGraph
    library: Library
    rules: Mapping[type, Rule]
    literals: Literals = field(default_factory=lambda: NO_LITERALS)  # those that are to be live
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
NO_VALUES: Mapping[str, Value] = MappingProxyType({})


class Names(Bindings[Value]):
    """The names visible at one place of an expression: local ones, then the file's."""

    __slots__ = ("context", "module")

    def __init__(
        self,
        context: Context,
        module: Module,
        values: Mapping[str, Value] = NO_VALUES,
        bindings: Sequence[tree.Binding] = (),
        parent: Names | None = None,
        calls: tuple[str, ...] = (),
    ) -> None:
        super().__init__(values, bindings, parent, calls)
        self.context = context
        self.module = module

    def compute(self, node: tree.Expression) -> Value:
        return evaluate(node, self)

    def within(self, name: str, value: Value) -> Names:
        """The same names and one more: a loop's variable, a row."""
        return Names(self.context, self.module, {name: value}, (), self, self.calls)

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
        return [*self.module.names(), *CONSTANTS, "true", "false", "nothing", *self.local_names()]


def evaluate(node: tree.Expression, names: Names) -> Value:
    """The value of an expression."""
    rule = names.context.rules.get(type(node))
    if rule is None:
        raise InternalError(f"no rule for {type(node).__name__} in a scene")
    return rule(node, names)


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
