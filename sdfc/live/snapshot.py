"""All files of a scene as they are at one moment, and what two such moments have between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from sdfc.api.source import Input, Kind, from_path
from sdfc.live.text import Literal, Text, opaque, read
from sdfc.scene.limits import LARGEST_FILE, MOST_FILES

Key: TypeAlias = tuple[str, int]
"""Which literal: the name of its source, and how many stand before it there."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A scene's own text and the files that it names, by the names of their sources."""

    given: Input = field(compare=False)
    texts: Mapping[str, Text]
    contents: Mapping[str, str] = field(repr=False)
    looked_at: tuple[Path, ...] = field(compare=False)  # files read, and those named that are not there

    def literal(self, key: Key) -> Literal:
        """The literal of that key."""
        return self.texts[key[0]].literals[key[1]]

    @property
    def folders(self) -> frozenset[Path]:
        """Where a save may happen that matters: of a folder that is not there yet, where it would be made."""
        return frozenset(_existing(path.parent) for path in self.looked_at)


@dataclass(frozen=True, slots=True)
class Edit:
    """What differs between two snapshots. `literals`: those with other values, where the structure is the same."""

    structure: bool = False
    camera: bool = False
    literals: tuple[Key, ...] = ()


def take(path: Path, kind: Kind | None = None) -> Snapshot:
    """The scene's files, now. Raises RequestError or SceneError where its own cannot be read."""
    given = from_path(path, kind)
    name = given.source.name
    looked_at = [path.absolute(), path.resolve()]
    if given.kind != "sdf" or given.folder is None:
        return Snapshot(given, {name: opaque(given.source.text)}, {name: given.source.text}, tuple(looked_at))
    texts, contents = {name: read(given.source.text)}, {name: given.source.text}
    waiting = [(name, given.folder)]
    while waiting and len(texts) < MOST_FILES:
        source, place = waiting.pop()
        for found, is_import in _named(texts[source], place, given.folder):
            looked_at.append(found)
            named = str(found.relative_to(given.folder))
            if named in texts:
                texts |= {named: opaque(contents[named])} if named == name and found != path.resolve() else {}
                continue
            content = _content(found)
            if content is None:
                continue
            contents[named] = content
            texts[named] = read(content) if is_import else opaque(content)
            if is_import:
                waiting.append((named, found.parent))
    return Snapshot(given, texts, contents, tuple(dict.fromkeys(looked_at)))


def _named(text: Text, place: Path, root: Path) -> Iterator[tuple[Path, bool]]:
    """The files inside of the scene's folder that a text names, and whether as an import."""
    for strings, is_import in ((text.imports, True), (text.strings, False)):
        for string in strings:
            try:
                path = (place / string).resolve()
            except (OSError, RuntimeError, ValueError):  # as in scene.files: no name of a file
                continue
            if string and path.is_relative_to(root):
                yield path, is_import


def _content(path: Path) -> str | None:
    try:
        if not path.is_file():
            return None
        with path.open("rb") as file:
            return file.read(LARGEST_FILE + 1).decode("utf-8-sig", "surrogateescape")
    except (OSError, ValueError):
        return None


def _existing(folder: Path) -> Path:
    while not folder.is_dir() and folder != folder.parent:
        folder = folder.parent
    return folder


def compare(before: Snapshot, after: Snapshot) -> Edit:
    """What an edit changed."""
    if before.texts.keys() != after.texts.keys():
        return Edit(structure=True)
    pairs = [(name, text, after.texts[name]) for name, text in before.texts.items()]
    if any(old is not new and old.structure != new.structure for _, old, new in pairs):
        return Edit(structure=True)
    changed = [
        (name, index)
        for name, old, new in pairs
        for index, literal in enumerate(old.literals)
        if literal.value != new.literals[index].value
    ]
    return Edit(False, any(old.camera != new.camera for _, old, new in pairs), tuple(changed))
