"""`import "file.sdf"`: every file once, none outside of the scene's folder, no cycles."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from sdfc.diagnostics import SceneError, scene_error
from sdfc.scene.files import Folder
from sdfc.scene.limits import MOST_FILES
from sdfc.scene.module import FileModule
from sdfc.scene.names import Context, Problems
from sdfc.syntax import tree
from sdfc.syntax.parse import parse


@dataclass(slots=True)
class _Loader:
    """The files read so far; `open` are those whose imports are being read."""

    context: Context
    folder: Folder
    problems: Problems
    done: dict[Path, FileModule] = field(default_factory=dict)
    open: list[Path] = field(default_factory=list)

    def module(self, file: tree.File, place: Path | None) -> FileModule:
        made = FileModule(file, self.context, self.folder, place)
        imported: list[tuple[tree.Import, FileModule]] = []
        for statement in file.statements:
            if isinstance(statement, tree.Import):
                try:
                    imported.append((statement, self.imported(statement, place)))
                except SceneError as error:
                    self.problems.take(error)
        made.declare(imported, self.problems)
        return made

    def imported(self, node: tree.Import, place: Path | None) -> FileModule:
        path = self.folder.find(node.path.value, place, node.path.span)
        if path in self.open:
            names = " → ".join(p.name for p in [*self.open[self.open.index(path) :], path])
            raise scene_error(f"this import closes a cycle: {names}", node.path.span)
        if path not in self.done:
            if len(self.done) + len(self.open) >= MOST_FILES:
                raise scene_error(f"a scene of more than {MOST_FILES} files", node.path.span)
            self.open.append(path)
            try:
                file = parse(self.folder.text(path, node.path.span))
                self.done[path] = self.module(file, path.parent)
                self.done[path].declare_params(self.problems)
            finally:
                self.open.pop()
        return self.done[path]


def load_modules(file: tree.File, context: Context, folder: Folder, problems: Problems) -> FileModule:
    """The module of the scene's own text, with all that it imports."""
    loader = _Loader(context, folder, problems)
    if folder.root is not None:
        loader.open.append(folder.root / Path(file.source.name).name)
    return loader.module(file, folder.root)
