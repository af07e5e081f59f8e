"""GLSL text as a list of global items: what lets a shader be pruned, prefixed, and lowered to a dialect.

It reads what our own templates and writers make, and no more than that of the language: no macros, no initialisers in
braces, `layout(...)` only at the start of an item.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

from sdfc.diagnostics import InternalError

_TOKEN = re.compile(r"//[^\n]*|[A-Za-z_]\w*|\.?\d(?:[\w.]|(?<=[eE])[+-])*|\s+|.", re.DOTALL)
_WORD = re.compile(r"[A-Za-z_]\w*\Z")
_COMMENT = re.compile(r"//[^\n]*")
_FREE_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")  # no member or component, no letter of a number
_FREE_WORD_OR_COMMENT = re.compile(rf"{_COMMENT.pattern}|{_FREE_WORD.pattern}")
_BOUNDARY = re.compile(r"//[^\n]*|[;(){}\[\]]")
_TRAILING = re.compile(r"[^\S\n]+//([^\n]*)")  # the comment behind an item, on its line
_QUALIFIERS = "const uniform inout in out flat noperspective highp writeonly readonly varying"
_QUALIFIED = re.compile(rf"(?:(?:{_QUALIFIERS.replace(' ', '|')})\b\s*)*")
_FUNCTION = re.compile(r"(\w+)\s+(\w+)\s*\(")


class Kind(Enum):
    """What an item declares."""

    DIRECTIVE = "directive"  # and precision statements
    STRUCT = "struct"
    CONSTANT = "constant"
    UNIFORM = "uniform"
    PORT = "port"  # an input or output of the stage
    VARIABLE = "variable"
    FUNCTION = "function"


@dataclass(frozen=True)
class Item:
    """One global declaration: the comments above it, its text up to the end of its last line."""

    kind: Kind
    names: tuple[str, ...]
    type: str
    text: str
    note: str = ""  # the comment behind it, without its slashes

    @cached_property
    def tokens(self) -> tuple[str, ...]:
        return tuple(_TOKEN.findall(self.text))

    @cached_property
    def words(self) -> frozenset[str]:
        """Every word of the code that is not a component or a member."""
        return frozenset(_FREE_WORD.findall(_COMMENT.sub("", self.text)))


def parse(text: str) -> list[Item]:
    """The items of a text, in order. Joined again by `joined`, they are the text but for its empty lines."""
    text = _split_directives(text)
    items: list[Item] = []
    start = depth = 0
    for found in _BOUNDARY.finditer(text):
        sign = found[0]
        if sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
        if depth or sign not in ";}":
            continue
        held = text[start : found.end()]
        code = _COMMENT.sub("", held).strip()
        if sign == "}" and (code.startswith("struct") or _is_block(code)):
            continue
        trailing = _TRAILING.match(text, found.end())
        items.append(_item(held.strip(), code, trailing[1].strip() if trailing else ""))
        start = trailing.end() if trailing else found.end()
    rest = text[start:].strip()
    if _COMMENT.sub("", rest).strip():
        raise InternalError(f"the generated GLSL ends in the middle of a declaration: {rest[:80]}")
    return items


def joined(items: Sequence[Item]) -> str:
    """The items as text: an empty line around functions and structs, and where there are comments above."""
    lines: list[str] = []
    before: Kind | None = None
    for item in items:
        is_long = "\n" in item.text or item.kind is Kind.STRUCT
        if before is not None and (is_long or before is not item.kind or _was_long(lines)):
            lines.append("")
        lines += [f"{item.text}  // {item.note}" if item.note else item.text]
        before = item.kind
    return "\n".join([*lines, ""])


def pruned(items: Sequence[Item], roots: Iterable[str]) -> list[Item]:
    """Only what the roots need; ports and directives stay."""
    by_name: dict[str, list[Item]] = {}
    for item in items:
        for name in item.names:
            by_name.setdefault(name, []).append(item)
    needed: set[int] = set()
    stack = [item for item in items if item.kind in (Kind.DIRECTIVE, Kind.PORT)]
    stack += [item for root in roots for item in by_name.get(root, [])]
    while stack:
        item = stack.pop()
        if id(item) not in needed:
            needed.add(id(item))
            stack.extend(other for word in by_name.keys() & item.words for other in by_name[word])
    return [item for item in items if id(item) in needed]


def renamed(items: Sequence[Item], names: Mapping[str, str]) -> list[Item]:
    """Every word that is a key of `names` replaced, but for members and components."""
    if not names:
        return list(items)
    return [
        replace(
            item,
            names=tuple(names.get(n, n) for n in item.names),
            type=names.get(item.type, item.type),
            text=_replaced(item, names),
        )
        for item in items
    ]


def globals_of(items: Sequence[Item]) -> tuple[str, ...]:
    """Every name that the items give to the whole shader, in order, once each."""
    return tuple(dict.fromkeys(name for item in items for name in item.names))


def _replaced(item: Item, names: Mapping[str, str]) -> str:
    if item.kind is not Kind.STRUCT:
        return _FREE_WORD_OR_COMMENT.sub(lambda found: names.get(found[0], found[0]), item.text)
    tokens = list(item.tokens)
    first = True  # of a member's declaration: its type
    braces = 0
    for index, token in enumerate(tokens):
        if token.isspace() or token.startswith("//"):
            continue
        braces += (token == "{") - (token == "}")
        if token in names and (not braces or first):
            tokens[index] = names[token]
        first = token in "{;"
    return "".join(tokens)


def _split_directives(text: str) -> str:
    """Directives end at the end of their lines: a mark that `parse` sees as the end of an item."""
    return re.sub(r"^(#[^\n]*)$", r"\1;", text, flags=re.MULTILINE)


def _is_block(code: str) -> bool:
    """Whether the braces are those of a uniform block."""
    return code.startswith(("layout", "uniform")) and "uniform" in code.split(maxsplit=6)[:6]


def _item(text: str, code: str, note: str) -> Item:
    """`code` is the text without its comments."""
    if code.startswith("#"):
        return Item(Kind.DIRECTIVE, (), "", text.removesuffix(";"), note)
    words = code.split(maxsplit=2)
    if words[0] == "precision":
        return Item(Kind.DIRECTIVE, (), "", text, note)
    if words[0] == "struct":
        return Item(Kind.STRUCT, (words[1],), words[1], text, note)
    if code.startswith("layout"):
        code = code[code.index(")") + 1 :].lstrip()
    qualifiers = _QUALIFIED.match(code)
    assert qualifiers is not None
    code = code[qualifiers.end() :]
    if code.startswith(";"):  # a compute shader's size
        return Item(Kind.PORT, (), "", text, note)
    function = _FUNCTION.match(code)
    if function:
        return Item(Kind.FUNCTION, (function[2],), function[1], text, note)
    type_, *declared = (token for token in _TOKEN.findall(code) if not token.isspace())
    return Item(_kind(qualifiers[0].split()), _declared(declared), type_, text, note)


def _kind(qualifiers: Sequence[str]) -> Kind:
    if "const" in qualifiers:
        return Kind.CONSTANT
    if "uniform" in qualifiers:
        return Kind.UNIFORM
    return Kind.PORT if {"in", "out"} & set(qualifiers) else Kind.VARIABLE


def _declared(code: Sequence[str]) -> tuple[str, ...]:
    """The names of `a = 1.0, b[2];`."""
    names, depth, is_next = [], 0, True
    for token in code:
        if is_next:
            names.append(token)
        is_next = token == "," and depth == 0
        depth += (token in "([") - (token in ")]") if len(token) == 1 else 0
    return tuple(n for n in names if _WORD.match(n))


def _was_long(lines: Sequence[str]) -> bool:
    return "\n" in lines[-1]
