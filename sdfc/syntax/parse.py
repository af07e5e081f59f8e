"""Text to syntax tree. Lark is imported, and the grammar's tables are read, when the first text is parsed."""

from __future__ import annotations

import re
import threading
from functools import cache
from typing import TYPE_CHECKING, cast

from sdfc import packaged
from sdfc.diagnostics import Diagnostic, SceneError, Source, Span, scene_error
from sdfc.syntax.build import Builder
from sdfc.syntax.tree import File, Statement

if TYPE_CHECKING:
    from lark import Lark

LARGEST_TEXT = 4 * 2**20  # characters
MOST_WORDS = 600_000
MOST_ERRORS = 10

_lock = threading.Lock()  # the builder holds the text at hand
_word = re.compile(r"[A-Za-z_0-9.]+|[^\sA-Za-z_0-9.]")
_statement = re.compile(r"^(?:import|param|material|camera|light|sky|def|field|scene)\b", re.MULTILINE)


def parse(source: Source) -> File:
    """The syntax tree of a whole text. Raises SceneError with every syntax error that could be told apart."""
    _check_text(source)
    statements: list[Statement] = []
    problems: list[Diagnostic] = []
    start: int | None = 0
    while start is not None and len(problems) < MOST_ERRORS:
        try:
            statements.extend(parse_part(source, start, len(source.text)))
            start = None
        except SceneError as error:
            problems.extend(error.diagnostics)
            start = _next_statement(source, error.diagnostics[0])
    if problems:
        raise SceneError(*problems)
    return File(source, tuple(statements))


def parse_part(source: Source, start: int, end: int) -> tuple[Statement, ...]:
    """The statements in part of a text; their places are in the whole. Raises SceneError at the first syntax error."""
    from lark.exceptions import UnexpectedInput

    part = source.text[start:end]
    with _lock:
        parser, builder = _parser()
        builder.begin(source, start)
        try:
            return cast("tuple[Statement, ...]", parser.parse(part))
        except UnexpectedInput as error:
            from sdfc.syntax.mistakes import explain

            raise SceneError(explain(source, start, end, error)) from None


def _next_statement(source: Source, problem: Diagnostic) -> int | None:
    """Where to go on after a syntax error: the next line that begins a statement."""
    if problem.span is None:
        return None
    line_end = source.text.find("\n", problem.span.start)
    found = _statement.search(source.text, line_end) if line_end >= 0 else None
    return found.start() if found else None


def _check_text(source: Source) -> None:
    if len(source.text) > LARGEST_TEXT:
        raise scene_error(
            f"{source.name} is too large: {len(source.text)} characters, and {LARGEST_TEXT} are allowed",
            hint="a table of many parts can be a CSV file, read with instances(...)",
        )
    if len(source.text) > MOST_WORDS and len(_word.findall(source.text)) > MOST_WORDS:
        raise scene_error(
            f"{source.name} is too large: more than {MOST_WORDS} words, numbers and signs",
            hint="a table of many parts can be a CSV file, read with instances(...)",
        )
    nul = source.text.find("\0")
    if nul >= 0:
        raise scene_error("a NUL character: this is not a text", Span(source, nul, nul + 1))


@cache
def _parser() -> tuple[Lark, Builder]:
    from sdfc.syntax.tables import load

    builder = Builder()
    return load((packaged.folder("sdfc.grammar") / "scene.lark").read_text(encoding="utf-8"), builder), builder
