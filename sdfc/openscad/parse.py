"""Text to calls. The nodes are made while the parser reduces, so that nesting is no limit."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from lark import Lark, Token, Transformer
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from sdfc import packaged
from sdfc.diagnostics import SceneError, Source, Span, scene_error
from sdfc.openscad.syntax import Argument, Call, Value
from sdfc.syntax.tables import load

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
        super().__init__(str(token))
        self.token = token


def _number(text: str) -> float:
    """May be infinite or not a number: ValueError where it is too large for a size."""
    value = float(text)
    if LARGEST < abs(value) < math.inf:
        raise ValueError(text)
    return value


class _Build(Transformer[Token, Any]):
    """One method for each rule, called when its parts have been read."""

    def start(self, children: list[Any]) -> tuple[Call, ...]:
        return tuple(children)

    def statement(self, children: list[Any]) -> Call:
        body = children.pop()
        first = next(i for i, c in enumerate(children) if c.type == "NAME")
        name = children[first]
        modifiers = "".join(children[:first])
        return Call(str(name), modifiers, tuple(children[first + 1 :]), body, name.start_pos, name.end_pos)

    def body(self, children: list[Any]) -> tuple[Call, ...]:
        return tuple(children)

    def argument(self, children: list[Any]) -> Argument:
        start, end, value = _value(children[-1])
        if len(children) == 1:
            return Argument(None, value, start, end)
        key = children[0]
        return Argument(key[:-1].rstrip(), value, key.start_pos, end)

    def list(self, children: list[Any]) -> tuple[int, int, Value]:
        first, *items, last = children
        return first.start_pos, last.end_pos, tuple(_value(item)[2] for item in items)


def _value(token: Any) -> tuple[int, int, Value]:
    """Start, end and value of a token, or of a list that was read."""
    if type(token) is tuple:
        return token
    try:
        value = _CONVERT[token.type](token)
    except (ValueError, KeyError):
        raise _WrongValueError(token) from None
    return token.start_pos, token.end_pos, value


_CONVERT: dict[str, Any] = {
    "NUMBER": _number,
    "NUMBERS": lambda token: tuple(_number(item) for item in token[1:-1].split(",")),
    "STRING": lambda token: token[1:-1],
    "NAME": lambda token: _WORDS[token],
}


@cache
def _parser() -> Lark:
    grammar = (packaged.folder("sdfc.grammar") / "csg.lark").read_text(encoding="utf-8")
    return load(grammar, _Build())


def parse(source: Source) -> tuple[Call, ...]:
    """The calls of a file, in order. Raises SceneError where it is not flattened CSG."""
    try:
        calls: tuple[Call, ...] = _parser().parse(source.text)  # type: ignore[assignment]
    except UnexpectedInput as error:
        raise _unexpected(source, error) from None
    except _WrongValueError as error:
        raise _wrong_value(source, error.token) from None
    return calls


def _wrong_value(source: Source, token: Token) -> SceneError:
    span = Span(source, token.start_pos or 0, token.end_pos or 0)
    if token.type == "NAME":
        return scene_error(
            f"`{token}` has no value here",
            span,
            FLATTEN,
        )
    return scene_error("this is no number, or too large a one", span, f"numbers go to {LARGEST:g}")


def _unexpected(source: Source, error: UnexpectedInput) -> SceneError:
    text = source.text
    match error:
        case UnexpectedToken(token=Token(type="$END")):
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
