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
_QUALIFIERS = frozenset(
    {"const", "uniform", "in", "out", "inout", "flat", "noperspective", "highp", "writeonly", "readonly", "varying"}
)


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
        return frozenset(w for w, is_member in _words(self.tokens) if not is_member)


def parse(text: str) -> list[Item]:
    """The items of a text, in order. Joined again by `joined`, they are the text but for its empty lines."""
    items: list[Item] = []
    held: list[str] = []
    depth = 0
    tokens = _TOKEN.findall(_split_directives(text))
    for index, token in enumerate(tokens):
        held.append(token)
        depth += (token in "({[") - (token in ")}]") if len(token) == 1 else 0
        if token.startswith("//") or depth or token not in (";", "}"):
            continue
        code = "".join(t for t in held if not t.startswith("//")).split()
        if token == "}" and (code[0] == "struct" or _is_block(code)):
            continue
        items.append(_item(held, _trailing(tokens, index)))
        held = []
    rest = "".join(held).strip()
    if any(not line.startswith("//") for line in rest.split("\n") if line):
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
            stack.extend(other for word in item.words for other in by_name.get(word, []))
    return [item for item in items if id(item) in needed]


def renamed(items: Sequence[Item], names: Mapping[str, str]) -> list[Item]:
    """Every word that is a key of `names` replaced, but for members and components."""
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
    tokens = list(item.tokens)
    is_struct = item.kind is Kind.STRUCT
    first = True  # of a member's declaration: its type
    previous = ""
    braces = 0
    for index, token in enumerate(tokens):
        if token.isspace() or token.startswith("//"):
            continue
        braces += (token == "{") - (token == "}")
        if token in names and previous != "." and (not is_struct or not braces or first):
            tokens[index] = names[token]
        first = token in "{;"
        previous = token
    return "".join(tokens)


def _words(tokens: Sequence[str]) -> Iterable[tuple[str, bool]]:
    previous = ""
    for token in tokens:
        if token.isspace() or token.startswith("//"):
            continue
        if _WORD.match(token):
            yield token, previous == "."
        previous = token


def _split_directives(text: str) -> str:
    """Directives end at the end of their lines: a mark that `parse` sees as the end of an item."""
    return re.sub(r"^(#[^\n]*)$", r"\1;", text, flags=re.MULTILINE)


def _trailing(tokens: list[str], index: int) -> str:
    """The comment behind an item, taken from the tokens that follow it on its line."""
    if index + 2 < len(tokens) and "\n" not in tokens[index + 1] and tokens[index + 2].startswith("//"):
        comment = tokens[index + 2]
        tokens[index + 2] = ""
        return comment.removeprefix("//").strip()
    return ""


def _is_block(code: Sequence[str]) -> bool:
    """Whether the braces are those of a uniform block."""
    return "uniform" in code[:6] and code[0].startswith(("layout", "uniform"))


def _item(held: Sequence[str], note: str) -> Item:
    text = "".join(held).strip()
    code = [t for t in held if not t.isspace() and not t.startswith("//") and t]
    if code[0] == "#":
        return Item(Kind.DIRECTIVE, (), "", text.removesuffix(";"), note)
    if code[0] == "precision":
        return Item(Kind.DIRECTIVE, (), "", text, note)
    if code[0] == "struct":
        return Item(Kind.STRUCT, (code[1],), code[1], text, note)
    code = _without_layout(code)
    qualifiers = [w for w in code if w in _QUALIFIERS] if code[0] in _QUALIFIERS else []
    while code[0] in _QUALIFIERS:
        code = code[1:]
    if code[0] == ";":  # a compute shader's size
        return Item(Kind.PORT, (), "", text, note)
    if code[2] == "(":
        return Item(Kind.FUNCTION, (code[1],), code[0], text, note)
    return Item(_kind(qualifiers), _declared(code[1:]), code[0], text, note)


def _kind(qualifiers: Sequence[str]) -> Kind:
    if "const" in qualifiers:
        return Kind.CONSTANT
    if "uniform" in qualifiers:
        return Kind.UNIFORM
    return Kind.PORT if {"in", "out"} & set(qualifiers) else Kind.VARIABLE


def _without_layout(code: list[str]) -> list[str]:
    return code[code.index(")") + 1 :] if code[0] == "layout" else code


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
