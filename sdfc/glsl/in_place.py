"""Small expressions, which are most: every text is written where it is used, so that there is nothing to order."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sdfc.field.graph import Expr, Op
from sdfc.glsl.composition import Text, clamp, clamp_limits, written

WIDTH = 90  # characters of one expression
DEPTH = 8  # operations nested in one expression
CHAIN = 4  # so many steps of min and max in a row become updates of one variable

_ANY = 0  # nobody asks how deep a text nests: there is room for so many operations below one another, and no more
_MIN, _MAX, _POW = Op.MIN, Op.MAX, Op.POW  # members of enums are dear to look up


class NeedsLocalError(Exception):
    """Something is used twice, or gets too long; or may need a local for another reason."""


class InPlace:
    """`there` gives the text of a leaf, and of what has a name already; None for what is to be written."""

    def __init__(self, there: Callable[[Expr], Text | None]) -> None:
        self._there = there
        self._texts: dict[Expr, Text] = {}
        self._text_of = self._texts.__getitem__
        self._given: list[Expr] = []  # what has a name already, and arguments
        self._extremes = 0

    def texts(self, roots: Sequence[Expr]) -> list[str]:
        """One text for each root. Raises NeedsLocalError."""
        for root in roots:
            self._write(root, DEPTH)
        for node in self._given:
            for argument in node.args:
                if argument in self._texts:  # its name stands for one more use of what it is made of
                    self._write(argument, 0)
        return [self._texts[root].text for root in roots]

    def _write(self, node: Expr, room: int) -> None:
        text = self._texts.get(node)
        if text is not None:
            if node.args and not text.is_name:
                raise NeedsLocalError  # used twice
            return
        text = self._there(node)
        if text is None:
            text = self._written(node, room)
        elif node.args:
            self._given.append(node)
        self._texts[node] = text

    def _written(self, node: Expr, room: int) -> Text:
        op = node.op
        self._extremes += op is _MIN or op is _MAX
        if room == 0 or op is _POW or self._extremes == CHAIN:
            raise NeedsLocalError
        for argument in node.args:
            self._write(argument, room - 1)
        limits = clamp_limits(node) if op is _MIN else None
        if limits is not None and not self._texts[node.args[0]].is_name:
            text = clamp(limits, node.type, self._text_of)
        else:
            text = written(node, self._text_of, _ANY)
        if len(text.text) > WIDTH:
            raise NeedsLocalError
        return text
