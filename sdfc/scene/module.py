"""One file's declarations: what they mean, found by name, made when first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, cast

from sdfc.diagnostics import Diagnostic, SceneError, Span, scene_error
from sdfc.field.graph import Expr
from sdfc.scene import settings
from sdfc.scene.calls import BUILT_IN
from sdfc.scene.check import has_sizes, try_out
from sdfc.scene.define import IN_PLANE, define, in_plane
from sdfc.scene.files import Folder, rows
from sdfc.scene.formula import Helper
from sdfc.scene.literals import literal
from sdfc.scene.names import Context, Names, Problems, evaluate
from sdfc.scene.params import declare
from sdfc.scene.values import Quantity, Row, Unit, Value
from sdfc.shape.definition import Definition
from sdfc.syntax import tree

Declaration: TypeAlias = (
    tree.FunctionDeclaration | tree.FieldDeclaration | tree.MaterialDeclaration | tree.ParamDeclaration
)
_DECLARATIONS: dict[type, str] = {
    tree.FunctionDeclaration: "a def",
    tree.FieldDeclaration: "a field",
    tree.MaterialDeclaration: "a material",
    tree.ParamDeclaration: "a param",
}


class FileModule:
    """A file, and the names that it sees: its own, and those of the files that it imports."""

    def __init__(self, file: tree.File, context: Context, folder: Folder, place: Path | None) -> None:
        self.file = file
        self.context = context
        self.folder = folder
        self.place = place  # the folder of this file
        self.own: dict[str, Declaration] = {}
        self.visible: dict[str, tuple[FileModule, Declaration]] = {}
        self._values: dict[str, Value] = {}
        self._definitions: dict[str, Definition] = {}
        self._tables: dict[Path, tuple[Row, ...]] = {}
        self._open: list[str] = []

    # --- declaring

    def declare(self, imported: Sequence[tuple[tree.Import, FileModule]], problems: Problems) -> None:
        """Takes in the file's declarations and what the imported files declare."""
        for statement in self.file.statements:
            if type(statement) in _DECLARATIONS:
                self._add(cast("Declaration", statement), self, statement.span, problems)
        for node, module in imported:
            for declaration in module.own.values():
                self._add(declaration, module, node.span, problems)

    def _add(self, declaration: Declaration, module: FileModule, place: Span, problems: Problems) -> None:
        name = declaration.name.text
        mine = module is self
        before = self.visible.get(name)
        if mine and name in BUILT_IN:
            message = f"'{name}' is a word of the language"
            problems.add(Diagnostic(message, declaration.name.span, "choose another name"))
        elif before is not None and before[1] is not declaration:
            what, where = _DECLARATIONS[type(before[1])], before[1].name.span
            message = f"'{name}' is declared twice"
            if not mine:
                message = f"this file declares '{name}', which is declared already"
            problems.add(Diagnostic(message, declaration.name.span if mine else place, f"it is {what} at {where}"))
        else:
            self.visible[name] = module, declaration
            if mine:
                self.own[name] = declaration

    def declare_params(self, problems: Problems) -> None:
        """Evaluates every param, and puts it among those of the scene."""
        for declaration in self.own.values():
            if isinstance(declaration, tree.ParamDeclaration):
                try:
                    declare(declaration, self.top())
                except SceneError as error:
                    problems.take(error)
                    # what uses it is not wrong for that: it goes on with the default alone
                    spare = problems.attempt(lambda d=declaration: evaluate(d.default, self.top()))  # type: ignore[misc]
                    self._values[declaration.name.text] = spare or Quantity(self.context.graph.constant(1.0))

    def top(self) -> Names:
        """The names outside of every function."""
        return Names(self.context, self)

    # --- what expressions ask

    def names(self) -> Sequence[str]:
        return list(self.visible)

    def _lookup(self, name: str, kind: type | tuple[type, ...]) -> tuple[FileModule, Any] | None:
        found = self.visible.get(name)
        return found if found is not None and isinstance(found[1], kind) else None

    def value(self, name: str, span: Span) -> Value | None:
        """A param, a material or a constant."""
        found = self.visible.get(name)
        if found is None:
            return None
        module, declaration = found
        rule = _VALUES.get(type(declaration))
        is_function = isinstance(declaration, tree.FunctionDeclaration) and declaration.parameters is not None
        if rule is None or is_function:
            raise scene_error(f"'{name}' needs its parentheses", span, f"write {name}(…)")
        value = module._values.get(name)
        if value is None:
            value = module._values[name] = module._make(name, lambda: rule(declaration, module), span)
        return value

    def _make(self, name: str, make: Callable[[], Value], span: Span) -> Value:
        if name in self._open:
            cycle = " → ".join([*self._open[self._open.index(name) :], name])
            raise scene_error(f"'{name}' is defined by itself: {cycle}", span)
        self._open.append(name)
        try:
            return make()
        finally:
            self._open.pop()

    def function(self, name: str) -> tuple[tree.FunctionDeclaration, FileModule] | None:
        """A `def` with parameters, and where it was written."""
        found = self._lookup(name, tree.FunctionDeclaration)
        if found is None or found[1].parameters is None:
            return None
        module, declaration = found
        return declaration, module

    def definition(self, name: str) -> Definition | None:
        """A `field`; with IN_PLANE behind its name, its twin for shapes in the plane."""
        found = self._lookup(name.removesuffix(IN_PLANE), tree.FieldDeclaration)
        if found is None:
            return None
        module, declaration = found
        made = module._definitions.get(name)
        if made is None:
            wanted = in_plane(declaration) if name.endswith(IN_PLANE) else declaration
            made = define(wanted, self.context.graph, Outside(module))
            if not has_sizes(made):  # those are tried wherever they are used
                try_out(made, self.context.graph)
            module._definitions[name] = made
        return made

    def table(self, path: str, span: Span) -> Sequence[Value]:
        """The rows of a CSV beside this file."""
        found = self.folder.find(path, self.place, span)
        if found not in self._tables:
            self._tables[found] = rows(self.folder.text(found, span), span)
        return self._tables[found]


class Outside:
    """What the formula of a user's field sees: numbers and functions of its file."""

    __slots__ = ("_module",)

    def __init__(self, module: FileModule) -> None:
        self._module = module

    def value(self, name: str, span: Span) -> Expr | None:
        value = self._module.value(name, span)
        if value is not None and not isinstance(value, Quantity):
            raise scene_error(f"'{name}' is not a number or a vector: a formula cannot use it", span)
        return None if value is None else value.expr

    def function(self, name: str) -> Helper | None:
        found = self._module.function(name)
        return None if found is None else Helper(found[0], Outside(found[1]))

    def names(self) -> Sequence[str]:
        return self._module.names()

    def literal(self, node: tree.Number, number: float) -> Expr | None:
        return literal(node, (number,), Unit.ANGLE if node.unit else Unit.NUMBER, self._module.context)

    def step(self, span: Span) -> None:
        self._module.context.budget.step(span)


def _constant(declaration: tree.FunctionDeclaration, module: FileModule) -> Value:
    return evaluate(declaration.body, Names(module.context, module, {}, declaration.where))


def _material(declaration: tree.MaterialDeclaration, module: FileModule) -> Value:
    given = settings.properties(declaration.properties, module.top())
    return settings.material(declaration.name.text, given, module.top(), declaration.name.span)


def _param(declaration: tree.ParamDeclaration, module: FileModule) -> Value:
    return declare(declaration, module.top())


_VALUES: Mapping[type, Callable[[Any, FileModule], Value]] = {
    tree.FunctionDeclaration: _constant,
    tree.MaterialDeclaration: _material,
    tree.ParamDeclaration: _param,
}
