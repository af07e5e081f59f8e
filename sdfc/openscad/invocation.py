"""One call as its module sees it: arguments by name, children made already, and the place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.diagnostics import SceneError, Span, scene_error
from sdfc.openscad.context import Context
from sdfc.openscad.part import Flat, Part, Solid
from sdfc.openscad.plane import Plane
from sdfc.openscad.syntax import Argument, Call, Value

FACETS_THAT_COUNT = 50  # an explicit $fn below this means the polygon; from here on it stands for the curve


@dataclass(frozen=True, slots=True, eq=False)
class Invocation:
    """`positional`: the names of arguments without a name, in order. `is_painted`: a colour outside of it rules."""

    call: Call
    context: Context
    children: Sequence[Part | None]
    positional: tuple[str, ...] = ()
    is_painted: bool = False

    @property
    def span(self) -> Span:
        return self.call.span(self.context.source)

    def argument(self, name: str) -> Argument | None:
        """The last argument of that name, as in OpenSCAD."""
        found = None
        unnamed = iter(self.positional)
        for argument in self.call.arguments:
            if (argument.name or next(unnamed, None)) == name:
                found = argument
        return found

    def place(self, argument: Argument) -> Span:
        return Span(self.context.source, argument.start, argument.end)

    def value(self, name: str) -> Value:
        found = self.argument(name)
        return None if found is None else found.value

    def wrong(self, name: str, expected: str) -> SceneError:
        found = self.argument(name)
        if found is None:
            return scene_error(f"`{self.call.name}` needs `{name}`: {expected}", self.span)
        if found.name is None:
            return scene_error(f"`{self.call.name}` takes {expected}", self.place(found))
        return scene_error(f"`{name}` of `{self.call.name}` must be {expected}", self.place(found))

    def number(self, name: str, default: float) -> float:
        """May be infinite or not a number, as OpenSCAD writes them."""
        match self.value(name):
            case None:
                return default
            case float(value):
                return value
            case _:
                raise self.wrong(name, "a number")

    def flag(self, name: str) -> bool:
        match self.value(name):
            case None:
                return False
            case bool(value):
                return value
            case float(value):
                return value != 0.0
            case _:
                raise self.wrong(name, "true or false")

    def numbers(self, name: str, count: int, default: float) -> tuple[float, ...]:
        """A vector; one number stands for all components."""
        match self.value(name):
            case None:
                return (default,) * count
            case float(value):
                return (value,) * count
            case tuple(values) if len(values) == count and all(type(v) is float for v in values):
                return values  # type: ignore[return-value]
            case _:
                raise self.wrong(name, f"a number or a list of {count} numbers")

    def points(self, name: str, size: int, expected: str = "") -> list[tuple[float, ...]]:
        """A list of points, or rows. They must be finite."""
        match self.value(name):
            case tuple(rows):
                made = [_vector(row) for row in rows]
                if all(len(row) == size and all(map(math.isfinite, row)) for row in made):
                    return made
        raise self.wrong(name, expected or f"a list of points, each of {size} finite numbers")

    def indices(self, name: str, count: int) -> list[tuple[int, ...]]:
        """A list of lists of indices below `count`."""
        match self.value(name):
            case tuple(rows):
                made = [_vector(row) for row in rows]
                if all(0.0 <= index < count for row in made for index in row):
                    return [tuple(int(index) for index in row) for row in made]
        raise self.wrong(name, f"a list of lists of indices, each from 0 to {count - 1}")

    def facets(self) -> int | None:
        """How many pieces a full circle has, where the file says so and few; None means the true curve."""
        count = self.number("$fn", 0.0)
        if not 0.0 < count < FACETS_THAT_COUNT:
            return None
        return max(3, int(count))

    def parts(self) -> list[Part]:
        """The children, without nothings, and all in the plane or all in space: as the first of them is."""
        made = [child for child in self.children if child is not None]
        kept = [child for child in made if type(child) is type(made[0])]
        for index, child in enumerate(self.children if len(kept) < len(made) else ()):
            if child is not None and type(child) is not type(made[0]):
                self._leave_out(index, "in space" if isinstance(made[0], Flat) else "in the plane")
        return kept

    def _leave_out(self, index: int, where: str) -> None:
        """Says so at the first call below the child that has none below it: what the file's author drew there."""
        call = self.call.shown[index]
        while call.shown:
            call = call.shown[0]
        first = "space" if where == "in the plane" else "the plane"
        message = f"`{call.name}` is {where} and left out: what stands first is in {first}"
        self.context.warn(message, call.span(self.context.source))

    def flats(self) -> list[Plane]:
        """The children in the plane. Solids are left out, with a warning."""
        if any(isinstance(child, Solid) for child in self.children):
            self.context.warn(f"`{self.call.name}` is of shapes in the plane: solids are left out", self.span)
        return [child.plane for child in self.children if isinstance(child, Flat)]


def _vector(row: Value) -> tuple[float, ...]:
    """The numbers of a list; a NaN, which no check lets through, for anything else."""
    match row:
        case tuple(items):
            return tuple(item if type(item) is float else math.nan for item in items)
        case _:
            return (math.nan,)
