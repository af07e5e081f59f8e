"""The machine reads every text as Lark does, whose tables it runs: the same calls in the same order, or both stop."""

import random
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from lark import Lark
from lark import Token as LarksToken
from lark.exceptions import UnexpectedInput
from mutations import mutated

from sdfc.diagnostics import Source
from sdfc.syntax import tables
from sdfc.syntax.machine import Machine, StuckError, Token

ROOT = Path(__file__).parent.parent.parent
TEXTS = {
    "scene.lark": [*ROOT.glob("scenes/**/*.sdf"), *ROOT.glob("sdfc/std/*.sdf")],
    "csg.lark": [*ROOT.glob("scenes/*.csg"), *ROOT.glob("tests/openscad/models/*.csg")],
}


class Calls:
    """Callbacks that remember what they were called with; what each makes is its place among the calls."""

    def __init__(self) -> None:
        self.made: list[tuple[Any, ...]] = []

    def __getattr__(self, name: str) -> Callable[[list[Any]], int]:
        if name.startswith("_") or name.isupper():
            raise AttributeError(name)

        def call(parts: list[Any]) -> int:
            self.made.append((name, *map(_plain, parts)))
            return len(self.made)

        return call


def _plain(part: Any) -> Any:
    match part:
        case Token():
            return part.type, part.text, part.span.start, part.span.end
        case LarksToken():
            return part.type, str(part), part.start_pos, part.end_pos
    return part


class Readers:
    """Both parsers of one grammar."""

    def __init__(self, name: str) -> None:
        grammar = files("sdfc.grammar").joinpath(name).read_text(encoding="utf-8")
        self.machines, self.larks = Calls(), Calls()
        self.machine: Machine = tables.load(grammar, self.machines)
        self.lark = Lark(grammar, parser="lalr", transformer=self.larks)

    def agree(self, text: str) -> bool:
        """Whether the text is of the grammar. Both say so, and make the same calls on their way."""
        self.machines.made.clear()
        self.larks.made.clear()
        answers = self._is_read(text), self._is_read_by_lark(text)
        assert answers[0] == answers[1]
        assert self.machines.made == self.larks.made
        return answers[0]

    def _is_read(self, text: str) -> bool:
        try:
            self.machine.parse(Source("", text))
        except StuckError:
            return False
        return True

    def _is_read_by_lark(self, text: str) -> bool:
        try:
            self.lark.parse(text)
        except UnexpectedInput:
            return False
        return True


@pytest.fixture(params=TEXTS)
def grammar(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


def test_every_text_is_read_as_by_lark(grammar: str) -> None:
    readers = Readers(grammar)
    assert len(TEXTS[grammar]) > 3
    for path in TEXTS[grammar]:
        assert readers.agree(path.read_text(encoding="utf-8")), path


def test_broken_texts_stop_both_at_the_same_place(grammar: str) -> None:
    readers = Readers(grammar)
    texts = [text for path in TEXTS[grammar] if len(text := path.read_text(encoding="utf-8")) < 4000]
    chance = random.Random(5)
    read = [readers.agree(mutated(chance, chance.choice(texts), texts)) for _ in range(200)]
    assert 10 < sum(read) < 190


def test_a_part_of_a_text_has_its_places_in_the_whole() -> None:
    calls = Calls()
    grammar = files("sdfc.grammar").joinpath("scene.lark").read_text(encoding="utf-8")
    text = "def a = 1 def b = 2 nonsense("
    tables.load(grammar, calls).parse(Source("", text), 10, 19)
    constant = calls.made[1]
    assert constant[:3] == ("constant", ("DEF", "def", 10, 13), ("NAME", "b", 14, 15))
