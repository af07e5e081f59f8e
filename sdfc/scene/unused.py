"""What is declared and never mentioned, and functions that lead back to themselves."""

from __future__ import annotations

from collections.abc import Iterator

from sdfc.diagnostics import Diagnostic
from sdfc.scene.library import standard_names
from sdfc.scene.module import FileModule
from sdfc.syntax import tree
from sdfc.syntax.walk import mentions

_WORDS: dict[type, str] = {
    tree.FunctionDeclaration: "def",
    tree.FieldDeclaration: "field",
    tree.MaterialDeclaration: "material",
    tree.ParamDeclaration: "param",
}


def unused(module: FileModule) -> list[Diagnostic]:
    """A warning for each declaration of the scene's own file that nothing leads to."""
    reached: set[str] = set()
    pending: list[object] = [s for s in module.file.statements if type(s) not in _WORDS]
    while pending:
        for name in mentions(pending.pop()).used:
            if name not in reached and name in module.own:
                reached.add(name)
                pending.append(module.own[name])
    return [
        Diagnostic(f"the {_WORDS[type(declaration)]} '{name}' is never used", declaration.name.span, None, "warning")
        for name, declaration in module.own.items()
        if name not in reached
    ]


def shadowing(module: FileModule) -> list[Diagnostic]:
    """A warning for each function of the scene's own file that takes the name of a standard field."""
    return [
        Diagnostic(
            f"'{name}' is also a shape or an operation of the library, which this hides",
            declaration.name.span,
            "give it another name",
            "warning",
        )
        for name, declaration in _functions(module)
        if name in standard_names()
    ]


def recursion(module: FileModule) -> list[Diagnostic]:
    """An error for each cycle of functions, at the function that closes it."""
    uses = {name: sorted(_uses(declaration) & module.own.keys()) for name, declaration in _functions(module)}
    done: set[str] = set()
    found: list[Diagnostic] = []
    for root in uses:
        path: list[str] = []
        stack: list[Iterator[str]] = [iter([root])]
        while stack:
            name = next(stack[-1], None)
            if name is None:
                stack.pop()
                if path:
                    done.add(path.pop())
            elif name in path:
                found.append(_cycle(module, [*path[path.index(name) :], name]))
            elif name not in done and name in uses:
                path.append(name)
                stack.append(iter(uses[name]))
    return found


def _cycle(module: FileModule, names: list[str]) -> Diagnostic:
    declaration = module.own[names[0]]
    return Diagnostic(
        f"'{names[0]}' calls itself: {' → '.join(names)}",
        declaration.name.span,
        "recursion is not possible: write a loop",
    )


def _functions(module: FileModule) -> Iterator[tuple[str, tree.FunctionDeclaration]]:
    for name, declaration in module.own.items():
        if isinstance(declaration, tree.FunctionDeclaration):
            yield name, declaration


def _uses(declaration: tree.FunctionDeclaration) -> frozenset[str]:
    """The names that the function takes from outside: not its own parameters, loops' variables and `where`."""
    found = mentions(declaration)
    own = {p.name.text for p in declaration.parameters or ()} | {b.name.text for b in declaration.where}
    return found.used - found.bound - own
