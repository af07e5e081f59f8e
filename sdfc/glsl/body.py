"""The body of one GLSL function while it is being written: statements in order, each with its place in the scene."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sdfc.diagnostics import Span
from sdfc.field.graph import LEAVES, Expr, Type
from sdfc.glsl.expression import Printer, local_name, type_name
from sdfc.glsl.functions import Call
from sdfc.glsl.live import Values
from sdfc.glsl.names import LOCALS, Names
from sdfc.shape.matrix import Matrix

_COMPONENTS = re.compile(r"\w+\.[xyzw]+")
_WORD = re.compile(r"\w+")
_DECLARED = re.compile(r"\w+ \w+(?= = )")
_ARGUMENT = [(before, after) for before in ("(", ", ") for after in (",", ")")]  # what stands beside one
_LONGEST = 112  # characters of a line that a point is written in: the scene's name before those of functions makes 120


def place(span: Span) -> str:
    """The comment that leads from a line of GLSL back to the scene: file name (no folder), line, column."""
    line, column = span.source.position(span.start)
    return f"{span.source.name.rsplit('/', 1)[-1]}:{line}:{column}"


class Body:
    """Statements. A point in a part's own space is computed once, where the first part needs it."""

    def __init__(self, live: Values, indent: int = 1) -> None:
        self.lines: list[str] = []
        self._live = live
        self._shares = live.shares
        self._indent = indent
        self._local: dict[Expr, str] = {}
        self._points: dict[str, str] = {}  # the texts of points that have a name
        self._once: set[str] = set()
        self._scope = Names(LOCALS)
        self._printer = Printer(self._name, self._scope)

    def _name(self, expr: Expr) -> str | None:
        name = self._local.get(expr) or self._live(expr)
        if name is None and self._shares and self._live.is_shared(expr):
            return self._share(expr)
        return name

    def _share(self, expr: Expr) -> str:
        """A local of the value, under a name of its own kind."""
        printer = Printer(lambda e: None if e is expr else self._name(e), self._scope)
        lines, (text,) = printer.statements([expr])
        self._local[expr] = name = self._scope.fresh(local_name(expr))
        for line in (*lines, f"{type_name(expr.type)} {name} = {text};"):
            self.add(line)
        return name

    def text(self, value: Expr) -> str:
        """The text of an expression, after the statements that it needs."""
        return self.texts([value])[0]

    def texts(self, values: Sequence[Expr]) -> list[str]:
        lines, texts = self._printer.statements(values)
        for line in lines:
            self.add(line)
        return texts

    def point(self, value: Expr, wanted: str) -> str:
        """The text of a point or direction: a local of its own unless it is only moved or given."""
        if value.op in LEAVES or all(a.op in LEAVES for a in value.args):
            return self.text(value)
        if value not in self._local:
            text = self.text(value)
            if _COMPONENTS.fullmatch(text):
                return text
            name = self._scope.fresh(wanted)
            self.add(f"{type_name(value.type)} {name} = {text};")
            self._local[value] = name
            self._points[name] = text
        return self._local[value]

    def add(self, line: str, span: Span | None = None) -> None:
        comment = f"  // {place(span)}" if span is not None else ""
        self.lines.append("    " * self._indent + line + comment)

    def once(self, line: str, span: Span | None = None) -> None:
        """Adds a statement unless it is there: a part that has several places in the tree has its values once."""
        # by what it declares: at the second place its text may read another local of the same value
        declared = _DECLARED.match(line)
        what = line if declared is None else declared[0]
        if what not in self._once:
            self._once.add(what)
            self.add(line, span)

    def declare(self, type_: Type, name: str, text: str, span: Span | None = None) -> None:
        self._scope.reserve(name)
        self.add(f"{type_name(type_)} {name} = {text};", span)

    def give(self, result: str) -> None:
        """Ends the function with its result. What the last statement makes is returned at once."""
        made = re.fullmatch(r"(\s*)(?:\w+ )?(\w+) = (.*)", self.lines[-1]) if self.lines else None
        if made is not None and made[2] == result:
            self.lines[-1] = f"{made[1]}return {made[3]}"
        else:
            self.add(f"return {result};")

    def written(self) -> list[str]:
        """The statements, and each point that is used once written where it is used, if the line stays short."""
        users: dict[str, list[int]] = {name: [] for name in self._points}
        for number, line in enumerate(self.lines):
            for word in _WORD.findall(line) if users else ():
                if word in users:
                    users[word].append(number)
        lines, gone = list(self.lines), set()
        declarations = {numbers[0] for numbers in users.values()}
        for name, text in self._points.items():
            # where another point is made of it, that may be written elsewhere itself
            if len(users[name]) != 2 or users[name][1] in declarations:
                continue
            declared, used = users[name]
            for before, after in _ARGUMENT:
                if before + name + after in lines[used] and len(lines[used]) - len(name) + len(text) <= _LONGEST:
                    lines[used] = lines[used].replace(before + name + after, before + text + after)
                    gone.add(declared)
        return [line for number, line in enumerate(lines) if number not in gone]

    def call(self, call: Call, leading: Sequence[str]) -> str:
        """The text of a call: point (and direction, growth) first, then the definition's own arguments."""
        return f"{call.name}({', '.join([*leading, *self.texts(call.arguments)])})"


def own_point(inverse: Matrix | None, p: Expr) -> Expr:
    """The point in a part's own space."""
    return p if inverse is None else inverse.apply(p)


def own_direction(inverse: Matrix | None, d: Expr) -> Expr:
    """The direction in a part's own space (not of unit length where the part is scaled)."""
    return d if inverse is None else inverse.direction(d)
