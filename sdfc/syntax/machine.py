"""Runs a grammar's LALR(1) tables over a text. Lark made the tables (syntax/tables.py), and says what is wrong."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from sdfc.diagnostics import Source, Span

END = "$END"
Part = Any  # a token, what a callback made, None for an optional part that is not there, or a list: a repetition


class Token:
    """A word of the text. `type` is its terminal in the grammar."""

    __slots__ = ("span", "text", "type")

    def __init__(self, type: str, text: str, span: Span) -> None:
        self.type, self.text, self.span = type, text, span


class Rule(NamedTuple):
    """One production: `size` symbols become one of `origin`.

    `callback` names what makes it of its parts; '' for a repetition, whose items go to the rule that it stands in,
    and None for a lone symbol that is passed on as it is. `layout` says which parts are kept, with None for an
    optional one that is not there; without a layout all are, and none is a repetition.
    """

    origin: str
    size: int
    callback: str | None
    layout: Sequence[int | None] | None


class Tables(NamedTuple):
    """All that a machine needs: JSON can hold it."""

    words: dict[str, str]  # reserved ones and their terminals, which come before all others
    terminals: Sequence[tuple[str, str]]  # the others and their patterns; the first that matches and may stand is meant
    ignored: Sequence[str]
    states: Sequence[dict[str, int]]  # by symbol: the next state; or, where negative, ~ the rule that is complete
    rules: Sequence[Rule]
    start: int
    end: int


class StuckError(Exception):
    """The text is not of the grammar."""


class Machine:
    """A parser. `callbacks` has a method for each name in the rules, which takes the rule's parts."""

    def __init__(self, tables: Tables, callbacks: object) -> None:
        self._tables = tables
        self._word = re.compile("|".join([f"(?P<{name}>{pattern})" for name, pattern in tables.terminals]))
        self._rules = [(rule.origin, rule.size, _maker(rule, callbacks)) for rule in tables.rules]

    def parse(self, source: Source, start: int = 0, end: int | None = None) -> Any:
        """What the callbacks made of (a part of) the text. Raises StuckError where it is not of the grammar."""
        states, rules, last = self._tables.states, self._rules, self._tables.end
        passed = [states[self._tables.start]]
        values: list[Part] = []
        for token in self._tokens(source, start, len(source.text) if end is None else end, passed):
            kind, state = token.type, passed[-1]
            while kind in state and (step := state[kind]) < 0:
                origin, size, make = rules[~step]
                if make is None:
                    state = passed[-1] = states[passed[-2][origin]]
                    continue
                parts = values[-size:] if size else []
                if size:
                    del values[-size:], passed[-size:]
                values.append(make(parts))
                step = passed[-1][origin]
                if step == last:
                    return values[0]
                state = states[step]
                passed.append(state)
            if kind not in state:
                break
            passed.append(states[step])
            values.append(token)
        raise StuckError

    def _tokens(self, source: Source, position: int, end: int, passed: list[dict[str, int]]) -> Iterator[Token]:
        """The words, each as the first terminal that matches and may stand in the state that was passed last."""
        text, match, words, ignored = source.text, self._word.match, self._tables.words, self._tables.ignored
        while found := match(text, position, end):
            kind, after = found.lastgroup, found.end()
            if kind not in ignored:
                state, reserved = passed[-1], words.get(text[position:after])
                if reserved in state:
                    kind = reserved
                elif kind not in state:
                    kind, after = self._second_choice(text, position, end, state)
                yield Token(kind, text[position:after], Span(source, position, after))
            position = after
        if position == end:
            yield Token(END, "", Span(source, end, end))

    def _second_choice(self, text: str, position: int, end: int, state: dict[str, int]) -> tuple[str, int]:
        for kind, pattern in self._tables.terminals:
            if kind in state and (found := re.compile(pattern).match(text, position, end)):
                return kind, found.end()
        raise StuckError


def _maker(rule: Rule, callbacks: object) -> Callable[[list[Part]], Part] | None:
    """What makes a rule's value of its parts; None passes on the only one."""
    if rule.callback is None:
        return None
    layout, make = rule.layout, getattr(callbacks, rule.callback) if rule.callback else None
    if layout is None:
        return make
    if list(layout) == list(range(rule.size)):
        return (lambda parts: make(_spliced(parts))) if make else _spliced

    def laid_out(parts: list[Part]) -> Part:
        kept = _spliced([None if place is None else parts[place] for place in layout])
        return make(kept) if make else kept

    return laid_out


def _spliced(parts: list[Part]) -> list[Part]:
    """The parts with what is repeated in the place of each repetition. A first one grows: a long one stays cheap."""
    whole = parts[0] if parts and type(parts[0]) is list else parts[:1]
    for part in parts[1:]:
        if type(part) is list:
            whole += part
        else:
            whole.append(part)
    return whole
