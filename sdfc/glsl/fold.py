"""A step tree folded into one value: a chain of statements, one a part, by a least and a greatest of its kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import assert_never

from sdfc.diagnostics import Span
from sdfc.glsl.body import Body
from sdfc.plan.steps import All, Any, Ball, Blend, Chord, Closed, Many, Part, Step, Tangent, Within


@dataclass(frozen=True, slots=True, eq=False)
class Operations:
    """What a value is, and how values are made and joined.

    type     Its GLSL type.
    nothing  The text of an empty scene's.
    union, intersection  GLSL functions of two.
    value    The text for a part, or for its complement where the flag is false.
    many     The text for a table, with a name for the variable that it may need.
    within   The text for a step whose inner text is given, and its box.
    """

    type: str
    nothing: str
    union: str
    intersection: str
    value: Callable[[Part, Body, bool], str]
    many: Callable[[Many, Body, str], str]
    within: Callable[[Within, str], str]


class Fold:
    """Writes one value of a whole scene."""

    def __init__(self, operations: Operations) -> None:
        self._with = operations
        self._count = 0

    def text(self, step: Step, body: Body) -> str:
        """The text of the step's value, after the statements that it needs."""
        match step:
            case Closed() | Ball():
                return self._with.value(step.part, body, step.inside)
            case Tangent() | Blend():
                return self._with.value(step.part, body, True)
            case Chord():
                return self._with.value(step.part, body, False)
            case Many():
                return self._with.many(step, body, self._fresh())
            case Within():
                return self._with.within(step, self.text(step.step, body))
            case Any():
                return self._joined(self._with.union, step.steps, body)
            case All():
                return self._joined(self._with.intersection, step.steps, body)
            case _:
                assert_never(step)

    def _joined(self, operation: str, steps: tuple[Step, ...], body: Body) -> str:
        if not steps:
            return self._with.nothing
        name = self._fresh()
        first = self.text(steps[0], body)
        body.add(f"{self._with.type} {name} = {first};", _place(steps[0]))
        for step in steps[1:]:
            text = self.text(step, body)
            body.add(f"{name} = {operation}({name}, {text});", _place(step))
        return name

    def _fresh(self) -> str:
        self._count += 1
        return f"d{self._count}"


def _place(step: Step) -> Span | None:
    """Where the scene says it, for a step that is one part."""
    match step:
        case Closed() | Tangent() | Chord() | Ball() | Blend():
            return step.part.span
        case Within() | Any() | All() | Many():
            return None
        case _:
            assert_never(step)
