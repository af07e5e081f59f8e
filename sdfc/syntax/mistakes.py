"""Syntax errors in words: what was expected, what is there, and for the common slips what to write."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdfc.diagnostics import Diagnostic, Source, Span

if TYPE_CHECKING:
    from lark.exceptions import UnexpectedInput

STATEMENTS = ("import", "param", "material", "camera", "light", "sky", "def", "field", "scene")
_VALUES = {"NUMBER", "COLOR", "STRING", "NAME", "CALLEE", "LPAR", "LBRACKET"}
_OPENING = {"(": ")", "[": "]", "{": "}"}
_CLOSING = {closing: opening for opening, closing in _OPENING.items()}

# what a terminal is called in a message
_WORDS = {
    "NAME": "a name",
    "CALLEE": "a call",
    "NUMBER": "a number",
    "STRING": "a string",
    "COLOR": "a colour",
    "COMPARISON": "a comparison",
    "EQUALS": "'='",
    "COLON": "':'",
    "COMMA": "','",
    "DOTDOT": "'..'",
    "DOT": "'.'",
    "BAR": "'|'",
    "AMPERSAND": "'&'",
    "PLUS": "'+'",
    "MINUS": "'-'",
    "STAR": "'*'",
    "SLASH": "'/'",
    "TILDE": "'~'",
    "LPAR": "'('",
    "RPAR": "')'",
    "LBRACKET": "'['",
    "RBRACKET": "']'",
    "LBRACE": "'{'",
    "RBRACE": "'}'",
}

# a character that is no part of the language, and what to write instead
_CHARACTERS = {
    ";": "no ';' is needed: leave it out",
    "!": "write 'not' for negation, and '!=' for unequal",
    "^": "write pow(a, b) for a power",
    "%": "write mod(a, b) for a remainder",
    "?": "write 'if condition then a else b'",
    "'": 'strings are written in double quotes: "file.sdf"',
    '"': "a string ends on its own line, with a second '\"'",
    "@": "",
    "$": "",
    "\\": "",
    "`": "",
}

# text just before and at the place, joined by a space: what to write instead
_PAIRS = {
    "& &": "write 'and' between conditions, '&' for an intersection",
    "| |": "write 'or' between conditions, '|' for a union",
    "* *": "write pow(a, b) for a power",
    "+ +": "",
}


@dataclass(frozen=True, slots=True)
class _Place:
    """What is known where the parser stopped. `found` is '' at the end of the text."""

    span: Span
    found: str
    terminal: str
    before: str
    expected: frozenset[str]


def explain(source: Source, start: int, end: int, error: UnexpectedInput) -> Diagnostic:
    """One diagnostic for what the parser could not go on from."""
    place = _place(source, start, end, error)
    if source.text.startswith("/*", place.span.start):
        opening = Span(source, place.span.start, place.span.start + 2)
        return Diagnostic("this comment is never closed", opening, "end it with '*/'")
    unbalanced = _unbalanced(source, start, end, place)
    if unbalanced is not None:
        return unbalanced
    for rule in (_slip_of_habit, _slip_of_character, _slip_of_pair, _slip_of_name, _slip_of_separator, _slip_at_top):
        found = rule(place)
        if found is not None:
            return Diagnostic(found[0], place.span, found[1])
    return Diagnostic(f"expected {_expected(place.expected)}, found {_found(place)}", place.span)


def _place(source: Source, start: int, end: int, error: UnexpectedInput) -> _Place:
    token = getattr(error, "token", None)
    expected = frozenset(getattr(error, "accepts", None) or getattr(error, "expected", None) or ())
    expected |= frozenset(getattr(error, "allowed", None) or ())
    if token is not None and token.type == "$END":
        last = len(source.text[start:end].rstrip()) + start
        return _Place(Span(source, last, last), "", "$END", _word_before(source, start, last), expected)
    offset = start + int(error.pos_in_stream or 0)
    text = str(token) if token is not None else source.text[offset : offset + 1]
    terminal = str(token.type) if token is not None else ""
    span = Span(source, offset, offset + max(1, len(text)))
    return _Place(span, text, terminal, _word_before(source, start, offset), expected)


def _word_before(source: Source, start: int, offset: int) -> str:
    tail = source.text[max(start, offset - 200) : offset].rstrip()
    found = re.search(r"(?:[A-Za-z_0-9.]+|\S)$", tail)
    return found.group(0) if found else ""


def _found(place: _Place) -> str:
    return f"'{place.found}'" if place.found else "the end of the text"


def _expected(expected: frozenset[str]) -> str:
    """The expected things, shortest useful list: values and operators are summed up."""
    rest = set(expected)
    words: list[str] = []
    if len(rest & _VALUES) >= 5:
        words.append("a value")
        rest -= _VALUES | {"MINUS", "PLUS", "TILDE", "NOT", "IF", "FOR"}
    if "BAR" in rest and "STAR" in rest:
        rest -= {"BAR", "AMPERSAND", "PLUS", "MINUS", "STAR", "SLASH", "AND", "OR", "COMPARISON", "DOT", "DOTDOT"}
        rest -= {"LBRACKET"}
        if not rest - {"$END"} - {s.upper() for s in STATEMENTS}:
            words.append("an operator")
    if {s.upper() for s in STATEMENTS} <= rest:
        words.append("a declaration")
        rest -= {s.upper() for s in STATEMENTS} | {"$END", "WHERE"}
        rest -= {"EXACT", "BOUND", "CONVEX", "HOMOGENEOUS", "DUAL", "REQUIRES"}
        rest -= {"LIPSCHITZ", "BOUNDS", "GAUGE", "RAY", "LOWERING"}
    words += sorted(_WORDS.get(name, f"'{name.lower()}'") for name in rest if name != "$END")
    if not words:
        return "the end of the text"
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " or " + words[-1]


_BRACKETS = re.compile(r'//[^\n]*|/\*.*?(?:\*/|\Z)|"[^"\n]*"?|[()\[\]{}]', re.DOTALL)


def _open_brackets(text: str) -> list[tuple[str, int]]:
    """The brackets that are open at the end of a text, outermost first, with their offsets."""
    stack: list[tuple[str, int]] = []
    for match in _BRACKETS.finditer(text):
        bracket = match.group(0)
        if bracket in _OPENING:
            stack.append((bracket, match.start()))
        elif bracket in _CLOSING and stack and stack[-1][0] == _CLOSING[bracket]:
            stack.pop()
    return stack


def _unbalanced(source: Source, start: int, end: int, place: _Place) -> Diagnostic | None:
    """The bracket that is not closed, or that closes nothing, where one explains the error."""
    stack = _open_brackets(source.text[start : place.span.start if place.found else end])
    if place.found in _CLOSING:
        if _CLOSING[place.found] not in [bracket for bracket, _ in stack]:
            return Diagnostic(f"'{place.found}' closes nothing", place.span, "is it one too many?")
        bracket, at = stack[-1]
        if _OPENING[bracket] != place.found:
            line, _ = source.position(start + at)
            message = f"'{place.found}' found, but the '{bracket}' of line {line} is still open"
            return Diagnostic(message, place.span, f"a '{_OPENING[bracket]}' is missing before this")
        return None
    at_statement = place.terminal in {s.upper() for s in STATEMENTS}
    if stack and (place.terminal == "$END" or (at_statement and _open_brackets(source.text[start:end]))):
        bracket, at = stack[-1]
        span = Span(source, start + at, start + at + 1)
        return Diagnostic(f"this '{bracket}' is never closed", span, f"a '{_OPENING[bracket]}' is missing")
    return None


_Slip = tuple[str, str | None]


def _slip_of_character(place: _Place) -> _Slip | None:
    if place.terminal:
        return None
    hint = _CHARACTERS.get(place.found)
    if hint is None and place.found.isalpha():
        hint = "names are made of the letters a to z and A to Z, digits and _"
    if place.found.isprintable() and place.found:
        return f"unexpected character '{place.found}'", hint or None
    return f"unexpected character U+{ord(place.found or ' '):04X}", None


def _slip_of_pair(place: _Place) -> _Slip | None:
    hint = _PAIRS.get(f"{place.before} {place.found}")
    return (f"'{place.before}{place.found}' is not an operator", hint or None) if hint is not None else None


def _slip_of_name(place: _Place) -> _Slip | None:
    """A word of the language where a name is wanted; a unit apart from its number."""
    wants_name = "NAME" in place.expected and len(place.expected & _VALUES) <= 2
    if wants_name and re.fullmatch(r"[a-z]+", place.found) and place.terminal not in ("NAME", "CALLEE"):
        return f"'{place.found}' is a word of the language and cannot be a name here", None
    if place.found in ("deg", "rad") and re.fullmatch(r"[0-9.]+", place.before):
        return "a unit stands right behind its number", f"write {place.before}{place.found}"
    return None


def _slip_of_habit(place: _Place) -> _Slip | None:
    """What other languages write so."""
    found = place.found
    after = place.span.source.text[place.span.end : place.span.end + 20].lstrip()
    if found == "(" and "EQUALS" in place.expected:
        return f"'{place.before}' is a word of the language and cannot be a name here", None
    if found == "(" and place.before == "for":
        return "a loop has no parentheses", "write for i in 0..3: …"
    if found == "{" and "EQUALS" in place.expected:
        return "expected '=', found '{'", "the body of a function is one expression: def f(x) = …"
    if "IMPORT" in place.expected and place.terminal == "NAME" and re.match(r"=(?!=)", after):
        return f"expected a declaration, found '{found}'", f"write def {found} = …"
    return None


def _slip_of_separator(place: _Place) -> _Slip | None:
    expected, found = place.expected, place.found
    if found == "=" and "COLON" in expected:
        return f"expected ':' after '{place.before}', found '='", f"write {place.before}: …"
    if found == "=" and "COMPARISON" in expected and "EQUALS" not in expected:
        return "unexpected '='", "write == to compare; in a call, a name and ':' give an argument"
    if found == ":" and "EQUALS" in expected:
        return f"expected '=' after '{place.before}', found ':'", f"write {place.before} = …"
    if "ELSE" in expected and "THEN" not in expected and place.terminal != "ELSE":
        return f"expected 'else', found {_found(place)}", "every 'if' needs both: if condition then a else b"
    if "THEN" in expected:
        return f"expected 'then', found {_found(place)}", "write if condition then a else b"
    if place.terminal == "COMPARISON":
        return f"unexpected '{found}'", "compare two values at a time, and join the comparisons with 'and'"
    if expected == {"STRING"}:
        return f"expected a string, found {_found(place)}", 'names of files stand in quotes: "file.sdf"'
    if "COMMA" in expected and (place.terminal in _VALUES or place.terminal in ("FOR", "IF")):
        return f"expected ',' before '{found}'", "a comma is missing"
    return None


def _slip_at_top(place: _Place) -> _Slip | None:
    """Something that is no declaration, where one should begin."""
    if not {s.upper() for s in STATEMENTS} <= place.expected or place.terminal not in _VALUES:
        return None
    close = difflib.get_close_matches(place.found, STATEMENTS, n=1)
    if close:
        return f"expected a declaration, found '{place.found}'", f"did you mean '{close[0]}'?"
    return f"expected a declaration, found '{place.found}'", "shapes are listed in scene { … }; a name is given by def"
