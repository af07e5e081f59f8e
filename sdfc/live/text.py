"""A scene's text as edits see it: its words, without blanks and comments, and its literals apart from them.

Two texts of one structure hash differ in nothing but the values of literals. What stands in `camera { … }` is kept
apart: it decides only from where the picture is taken.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal as Choice
from typing import TypeAlias

from sdfc.diagnostics import SceneError, Source, Span
from sdfc.scene.color import hexadecimal
from sdfc.scene.units import UNITS
from sdfc.syntax import tree

Unit: TypeAlias = Choice["number", "angle", "color"]

# As in grammar/scene.lark. A name is another word where its parenthesis stands on the same line.
_WORD = re.compile(
    r"""(?P<blank>[ \t\r\n\f\ufeff]+|//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/)
      | (?P<number>(?:[0-9]+(?:\.(?![.A-Za-z_])[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?P<unit>[A-Za-z_%]*)
      | (?P<color>\#[0-9A-Za-z_]*)
      | (?P<string>"[^"\n]*")
      | (?P<callee>[A-Za-z_][A-Za-z_0-9]*(?=[ \t]*\())
      | (?P<name>[A-Za-z_][A-Za-z_0-9]*)
      | (?P<sign><=|>=|==|!=|\.\.|.)""",
    re.VERBOSE | re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class Literal:
    """A number or a colour, as it is inside: radians, linear RGB. `start`: its offset; `word`: its place in `words`."""

    start: int
    word: int
    unit: Unit
    value: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Text:
    """One file of a scene, without its camera. `words` have a literal's unit in the place of the literal."""

    words: tuple[str, ...]
    literals: tuple[Literal, ...]
    camera: tuple[str, ...] = ()
    imports: tuple[str, ...] = ()
    strings: tuple[str, ...] = ()  # the others, which may be names of tables

    @property
    def structure(self) -> str:
        """Equal for texts that differ in nothing but the values of literals (and the camera)."""
        return hashlib.sha256("\n".join(self.words).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class _Word:
    text: str
    literal: Literal | None = None


def read(text: str) -> Text:
    """The words of any text, a broken one as well."""
    words, camera = _without_camera(list(_words(text)))
    literals = [_placed(w.literal, index) for index, w in enumerate(words) if w.literal is not None]
    strings = [(words[i - 1].text if i else "", w.text[1:-1]) for i, w in enumerate(words) if w.text[:1] == '"']
    return Text(
        words=tuple(w.text for w in words),
        literals=tuple(literals),
        camera=tuple(f"{w.text} {w.literal.value}" if w.literal is not None else w.text for w in camera),
        imports=tuple(string for before, string in strings if before == "import"),
        strings=tuple(string for before, string in strings if before != "import"),
    )


def opaque(text: str) -> Text:
    """What is no scene text, a table for one: any change is one of structure."""
    return Text((text,), ())


def _placed(literal: Literal, word: int) -> Literal:
    return Literal(literal.start, word, literal.unit, literal.value)


def _words(text: str) -> Iterator[_Word]:
    for match in _WORD.finditer(text):
        match match.lastgroup:
            case "blank":
                pass
            case "number" | "unit":
                literal = _number(match["number"], match["unit"], match.start())
                yield _Word(match[0]) if literal is None else _Word(f"<{literal.unit}>", literal)
            case "color":
                literal = _color(match[0], match.start())
                yield _Word(match[0]) if literal is None else _Word("<color>", literal)
            case "callee":
                yield _Word(f"{match[0]}(")
            case _:
                yield _Word(match[0])


def _number(digits: str, unit: str, start: int) -> Literal | None:
    if unit not in UNITS:
        return None
    return Literal(start, 0, "angle" if unit else "number", (float(digits) * UNITS[unit],))


def _color(word: str, start: int) -> Literal | None:
    node = tree.Color(Span(Source("", word), 0, len(word)), word[1:])
    try:
        return Literal(start, 0, "color", hexadecimal(node))
    except SceneError:
        return None


def _without_camera(words: Sequence[_Word]) -> tuple[list[_Word], list[_Word]]:
    """The words outside and inside of `camera { … }`; its own word and brackets stay outside."""
    outside: list[_Word] = []
    inside: list[_Word] = []
    depth, camera = 0, 0  # brackets open here; at which depth the camera's contents are (0: not in one)
    for index, word in enumerate(words):
        if word.text == "}":
            depth -= 1
            camera = camera if depth >= camera else 0
        (inside if camera else outside).append(word)
        if word.text == "{":
            depth += 1
            if depth == 1 and index and words[index - 1].text == "camera":
                camera = 1
    return outside, inside


def kept(before: Sequence[str], after: Sequence[str]) -> dict[int, int]:
    """Which word after an edit is which before it: those of the common beginning and of the common end."""
    most = min(len(before), len(after))
    start = 0
    while start < most and before[start] == after[start]:
        start += 1
    end = 0
    while end < most - start and before[-1 - end] == after[-1 - end]:
        end += 1
    pairs = {index: index for index in range(start)}
    pairs |= {len(before) - back: len(after) - back for back in range(1, end + 1)}
    return pairs
