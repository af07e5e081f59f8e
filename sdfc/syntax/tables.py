"""A grammar's tables, made by Lark and kept between runs: making them takes longer than parsing most scenes.

Lark is imported only where there are none yet, and to say what is wrong with a text.
"""

from __future__ import annotations

import re
from functools import cache
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from sdfc.cache import recall, remember
from sdfc.diagnostics import InternalError
from sdfc.syntax.machine import Machine, Rule, Tables

if TYPE_CHECKING:
    from lark import Lark
    from lark.exceptions import UnexpectedInput

_WORD = re.compile(r"[a-z]+\\b")  # a pattern that is nothing but a word
KIND = "grammar-1"  # counts up where what is kept of a grammar becomes another thing


def load(grammar: str, callbacks: object) -> Machine:
    """An LALR(1) parser of `grammar` that calls `callbacks` (methods named as its rules) as it reduces."""
    kept = recall(KIND, grammar)
    if kept is None:
        kept = _tables(_lark(grammar))
        remember(KIND, grammar, kept)
    found = Tables(*kept)
    return Machine(found._replace(rules=[Rule(*rule) for rule in found.rules]), callbacks)


def mistake(grammar: str, text: str) -> UnexpectedInput:
    """What Lark says of a text that is not of the grammar."""
    from lark.exceptions import UnexpectedInput

    try:
        _lark(grammar).parse(text)
    except UnexpectedInput as error:
        return error
    raise InternalError("a grammar's tables do not agree with it")


@cache
def _lark(grammar: str) -> Lark:
    from lark import Lark

    return Lark(grammar, parser="lalr")


def _tables(lark: Lark) -> Tables:
    """The tables that Lark parses by: it has no public way to them."""
    frontend: Any = lark.parser
    found = frontend.parser._parse_table
    (start,), (end,) = found.start_states.values(), found.end_states.values()
    numbers: dict[Any, int] = {}
    states: list[dict[str, int]] = [{} for _ in found.states]
    for state, row in found.states.items():
        for symbol, (_, target) in row.items():
            is_shift = isinstance(target, int)
            states[state][symbol] = target if is_shift else ~numbers.setdefault(target, len(numbers))
    terminals = [(t.name, t.pattern.to_regexp()) for t in frontend.lexer.root_lexer.terminals]
    words = list(takewhile(lambda terminal: _WORD.fullmatch(terminal[1]), terminals))
    return Tables(
        words={pattern.removesuffix(r"\b"): name for name, pattern in words},
        terminals=terminals[len(words) :],
        ignored=lark.ignore_tokens,
        states=states,
        rules=[_rule(production) for production in numbers],
        start=start,
        end=end,
    )


def _rule(production: Any) -> Rule:
    """A production as Lark means it: `_` before a name, `?` before a rule, `->` behind it, `[…]`."""
    origin, symbols, options = production.origin.name, production.expansion, production.options
    if options.expand1 and production.alias is None and len(symbols) == 1:
        return Rule(origin, 1, None, None)
    # of the symbols, and what is not there at all, in order: Lark tells them apart by a flag each
    places = iter(range(len(symbols)))
    order = [None if is_absent else next(places) for is_absent in options.empty_indices or [False] * len(symbols)]
    layout = [place for place in order if place is None or not getattr(symbols[place], "filter_out", False)]
    is_plain = layout == list(range(len(symbols))) and not any(_is_repetition(s.name) for s in symbols)
    callback = "" if _is_repetition(origin) else production.alias or origin
    return Rule(origin, len(symbols), callback, None if is_plain and callback else layout)


def _is_repetition(name: str) -> bool:
    return name.startswith("_") and not name.isupper()
