"""Text to calls. The nodes are made while the parser reduces, so that nesting is no limit."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

from sdfc import packaged
from sdfc.diagnostics import SceneError, Source, Span, scene_error
from sdfc.openscad.syntax import Argument, Call, Value
from sdfc.syntax import tables
from sdfc.syntax.machine import END, Machine, StuckError, Token

if TYPE_CHECKING:
    from lark.exceptions import UnexpectedInput

LARGEST = 1e12
FLATTEN = "flattened CSG has no variables: write it with `openscad -o model.csg model.scad`"
_WORDS: dict[str, Value] = {"true": True, "false": False, "undef": None}
_READABLE = {
    "_LEFT": "`(`",
    "_RIGHT": "`)`",
    "_OPEN": "`{`",
    "_CLOSE": "`}`",
    "_END": "`;`",
    "_COMMA": "`,`",
    "LIST_OPEN": "`[`",
    "LIST_CLOSE": "`]`",
    "MODIFIER": "a modifier",
    "NAME": "a name",
    "KEY": "`name =`",
    "NUMBER": "a number",
    "NUMBERS": "a list of numbers",
    "STRING": "a text in quotes",
    "$END": "the end of the file",
}


class _WrongValueError(Exception):
    """A token that no value can be made of; carries it."""

    def __init__(self, token: Token) -> None:
        super().__init__(token.text)
        self.token = token


def _number(text: str) -> float:
    """May be infinite or not a number: ValueError where it is too large for a size."""
    value = float(text)
    if LARGEST < abs(value) < math.inf:
        raise ValueError(text)
    return value


class _Build:
    """One method for each rule, called when its parts have been read."""

    def start(self, children: list[Any]) -> tuple[Call, ...]:
        return tuple(children)

    def statement(self, children: list[Any]) -> Call:
        body = children.pop()
        first = next(i for i, c in enumerate(children) if c.type == "NAME")
        name = children[first]
        modifiers = "".join([modifier.text for modifier in children[:first]])
        return Call(name.text, modifiers, tuple(children[first + 1 :]), body, name.span.start, name.span.end)

    def body(self, children: list[Any]) -> tuple[Call, ...]:
        return tuple(children)

    def argument(self, children: list[Any]) -> Argument:
        start, end, value = _value(children[-1])
        if len(children) == 1:
            return Argument(None, value, start, end)
        key = children[0]
        return Argument(key.text[:-1].rstrip(), value, key.span.start, end)

    def list(self, children: list[Any]) -> tuple[int, int, Value]:
        first, *items, last = children
        return first.span.start, last.span.end, tuple([_value(item)[2] for item in items])


def _value(token: Any) -> tuple[int, int, Value]:
    """Start, end and value of a token, or of a list that was read."""
    if type(token) is tuple:
        return token
    try:
        value = _CONVERT[token.type](token.text)
    except (ValueError, KeyError):
        raise _WrongValueError(token) from None
    return token.span.start, token.span.end, value


_CONVERT: dict[str, Any] = {
    "NUMBER": _number,
    "NUMBERS": lambda text: tuple([_number(item) for item in text[1:-1].split(",")]),
    "STRING": lambda text: text[1:-1],
    "NAME": lambda text: _WORDS[text],
}


@cache
def _machine() -> Machine:
    return tables.load(_grammar(), _Build())


def _grammar() -> str:
    return (packaged.folder("sdfc.grammar") / "csg.lark").read_text(encoding="utf-8")


def parse(source: Source) -> tuple[Call, ...]:
    """The calls of a file, in order. Raises SceneError where it is not flattened CSG."""
    try:
        calls: tuple[Call, ...] = _machine().parse(source)
    except StuckError:
        raise _unexpected(source, tables.mistake(_grammar(), source.text)) from None
    except _WrongValueError as error:
        raise _wrong_value(error.token) from None
    return calls


def _wrong_value(token: Token) -> SceneError:
    if token.type == "NAME":
        return scene_error(f"`{token.text}` has no value here", token.span, FLATTEN)
    return scene_error("this is no number, or too large a one", token.span, f"numbers go to {LARGEST:g}")


def _unexpected(source: Source, error: UnexpectedInput) -> SceneError:
    from lark.exceptions import UnexpectedCharacters, UnexpectedToken

    text = source.text
    match error:
        case UnexpectedToken(token=token) if token.type == END:
            end = len(text.rstrip())
            return scene_error(
                "the file ends in the middle of a statement",
                Span(source, max(0, end - 1), max(1, end)),
                f"expected {_expected(error.expected)}",
            )
        case UnexpectedToken(token=token):
            span = Span(source, token.start_pos or 0, token.end_pos or 0)
            return scene_error(f"`{_short(token)}` is not expected here", span, f"expected {_expected(error.expected)}")
        case UnexpectedCharacters():
            start = error.pos_in_stream or 0
            span = Span(source, start, start + 1)
            hint = FLATTEN if text[start] == "=" else f"expected {_expected(error.allowed or ())}"
            return scene_error(f"{text[start]!r} is not expected here", span, hint)
    return scene_error("this is not flattened CSG", Span(source, 0, 1))


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."


def _expected(names: Any) -> str:
    words = sorted({_READABLE[name] for name in names if name in _READABLE})
    if not words:
        return "something else"
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
