"""Files that a scene names: only those in its own folder, and only as data."""

from __future__ import annotations

from pathlib import Path

from sdfc.diagnostics import Source, Span, scene_error
from sdfc.scene.bindings import did_you_mean
from sdfc.scene.limits import LARGEST_FILE, MOST_ROWS
from sdfc.scene.values import Row


class Folder:
    """The folder of a scene. `read` are the files read so far."""

    __slots__ = ("_root", "read")

    def __init__(self, root: Path | None) -> None:
        self._root = None if root is None else root.resolve()
        self.read: list[str] = []

    @property
    def root(self) -> Path | None:
        return self._root

    def find(self, name: str, beside: Path | None, span: Span) -> Path:
        """The real path of a file named in a text of the folder `beside`. Raises SceneError for any other file."""
        if self._root is None or beside is None:
            raise scene_error("a scene without a file cannot read other files", span, "save it, and give its path")
        if not name or "\0" in name or len(name) > 1000:
            raise scene_error("this is not the name of a file", span)
        try:
            path = (beside / name).resolve()
            inside = path.is_relative_to(self._root)
            exists = inside and path.is_file()
        except (OSError, RuntimeError, ValueError):  # a loop of links, a name too long for the system
            raise scene_error(f"cannot read {_quoted(name)}", span) from None
        if not inside:
            raise scene_error(
                f"{_quoted(name)} is outside of the scene's folder", span, "a scene reads files of its own folder only"
            )
        if not exists:
            what = "is a folder" if path.is_dir() else "does not exist"
            raise scene_error(f"the file {_quoted(name)} {what}", span, None if path.is_dir() else self._near(path))
        return path

    def _near(self, path: Path) -> str | None:
        try:
            return did_you_mean(path.name, [entry.name for entry in list(path.parent.iterdir())[:1000]])
        except OSError:
            return None

    def text(self, path: Path, span: Span) -> Source:
        """The file's text."""
        try:
            with path.open("rb") as file:
                data = file.read(LARGEST_FILE + 1)
        except OSError as error:
            raise scene_error(f"cannot read {_quoted(path.name)}: {error.strerror}", span) from None
        if len(data) > LARGEST_FILE:
            raise scene_error(f"{_quoted(path.name)} is larger than {LARGEST_FILE} bytes", span)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise scene_error(f"{_quoted(path.name)} is not UTF-8 text", span) from None
        self.read.append(str(path))
        name = path.relative_to(self._root) if self._root is not None else path
        return Source(str(name), text)


def _quoted(name: str) -> str:
    return f"'{name}'"


def rows(source: Source, span: Span) -> tuple[Row, ...]:
    """The rows of a CSV; its first line names the columns."""
    import csv

    reader = csv.reader(source.text.splitlines(keepends=True), skipinitialspace=True)
    starts = _line_starts(source.text)
    found: list[Row] = []
    columns: list[str] | None = None
    try:
        for cells in reader:
            line = min(reader.line_num, len(starts)) - 1
            place = Span(source, starts[line], _line_end(source.text, starts[line]))
            if not any(cell.strip() for cell in cells):
                continue
            if columns is None:
                columns = _columns(cells, place)
                continue
            if len(cells) != len(columns):
                raise scene_error(f"{len(cells)} cells in this row, and {len(columns)} columns", place)
            found.append(Row(dict(zip(columns, cells, strict=True)), source, place))
            if len(found) > MOST_ROWS:
                raise scene_error(f"the table '{source.name}' has more than {MOST_ROWS} rows", span)
    except csv.Error as error:
        raise scene_error(f"'{source.name}' is not a CSV table: {error}", span) from None
    if columns is None:
        raise scene_error(f"the table '{source.name}' is empty", span, "its first line names the columns")
    return tuple(found)


def _columns(cells: list[str], place: Span) -> list[str]:
    columns = [cell.strip() for cell in cells]
    for column in columns:
        if columns.count(column) > 1:
            raise scene_error(f"two columns are called '{column}'", place)
        if not column.isidentifier():
            raise scene_error(f"'{column}' is not the name of a column", place, "the first line names the columns")
    return columns


def _line_starts(text: str) -> list[int]:
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    return starts


def _line_end(text: str, start: int) -> int:
    end = text.find("\n", start)
    return len(text) if end < 0 else end
