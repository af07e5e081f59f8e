"""Local names: arguments, variables of loops, and what `where` defines, evaluated when it is asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic, TypeVar

from sdfc.diagnostics import Span, scene_error
from sdfc.syntax import tree

V = TypeVar("V")


class Bindings(ABC, Generic[V]):
    """The local names at one place, within those of `parent`; `calls` are the functions being expanded."""

    __slots__ = ("bindings", "calls", "open", "parent", "values")

    def __init__(
        self,
        values: Mapping[str, V],
        bindings: Sequence[tree.Binding],
        parent: Bindings[V] | None,
        calls: tuple[str, ...],
    ) -> None:
        self.values: dict[str, V] = dict(values)
        self.bindings = {b.name.text: b for b in bindings}
        self.open: set[str] = set()
        self.parent = parent
        self.calls = calls

    @abstractmethod
    def compute(self, node: tree.Expression) -> V:
        """The value of an expression that stands here."""

    def local(self, name: str, span: Span) -> V | None:
        """The value of a local name, or None where there is none."""
        scope: Bindings[V] | None = self
        while scope is not None:
            if name in scope.values:
                return scope.values[name]
            if name in scope.bindings:
                return scope._bound(scope.bindings[name], span)
            scope = scope.parent
        return None

    def _bound(self, binding: tree.Binding, span: Span) -> V:
        name = binding.name.text
        if name in self.open:
            raise scene_error(f"'{name}' is defined by itself", span)
        self.open.add(name)
        value = self.values[name] = self.compute(binding.value)
        self.open.discard(name)
        return value

    def local_names(self) -> list[str]:
        """All local names."""
        names: list[str] = []
        scope: Bindings[V] | None = self
        while scope is not None:
            names += [*scope.values, *scope.bindings]
            scope = scope.parent
        return names

    def check_call(self, name: str, span: Span) -> None:
        """Raises SceneError where the function is being expanded already."""
        if name in self.calls:
            cycle = " → ".join([*self.calls[self.calls.index(name) :], name])
            raise scene_error(f"'{name}' calls itself: {cycle}", span, "recursion is not possible: write a loop")


def did_you_mean(name: str, known: Sequence[str]) -> str | None:
    """A hint with the nearest known name, if there is one near."""
    from difflib import get_close_matches

    close = get_close_matches(name, sorted(set(known)), n=1)
    return f"did you mean '{close[0]}'?" if close else None
