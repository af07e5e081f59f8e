"""Texts that nobody would write: random bytes, token soup, real scenes with something broken. Seeded: repeatable."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

VOCABULARY = """\
scene { } ( ) [ ] , : ; . .. = + - * / & | ~ < <= > >= == -> # @ \\ " ' // 0 1 -1 0.5 1e308 1e-320 30deg 2rad #ff0000
def for in if then else param material camera light sun point sky field where import and or not true false pi tau inf
union intersection difference sphere box cylinder torus plane capsule polygon revolve extrude translate rotate scale
round shell blend radius size height instances row.x exact bounds lipschitz convex p p.x x y i eye target fov
\xe9 \u2028 \x00"""
TOKENS = (*VOCABULARY.split(), "\n", "\u2028")
NASTY_NUMBERS = (
    *("0", "-0", "-1", "1e400", "1e308", "-1e308", "1e-320", "0.0000001", "1e9", "123456789012345678901234567890"),
    *("inf", "-inf", "(0/0)", "1/0", "true", "[1, 2]", "[]", "30deg", "#abcdef"),
)
NUMBER = re.compile(r"(?<![\w.#])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?:deg|rad)?")
WORD = re.compile(r"[A-Za-z_]\w*")


def random_bytes(chance: random.Random) -> bytes:
    """Any bytes, printable ones, or tokens of the language in any order."""
    length = chance.choice((0, 1, 8, 60, 400, 3000))
    match chance.randrange(3):
        case 0:
            return chance.randbytes(length)
        case 1:
            return bytes(chance.randrange(32, 127) for _ in range(length))
        case _:
            return " ".join(chance.choice(TOKENS) for _ in range(min(length, 400))).encode()


def _span(chance: random.Random, text: str, longest: int) -> tuple[int, int]:
    start = chance.randrange(len(text) + 1)
    return start, min(len(text), start + chance.randrange(longest + 1))


def _delete(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    start, end = _span(chance, text, 40)
    return text[:start] + text[end:]


def _repeat(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    start, end = _span(chance, text, 60)
    return text[:end] + text[start:end] * chance.choice((1, 2, 50)) + text[end:]


def _insert_token(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    at = chance.randrange(len(text) + 1)
    return f"{text[:at]} {chance.choice(TOKENS)} {text[at:]}"


def _break_number(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    places = list(NUMBER.finditer(text))
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + chance.choice(NASTY_NUMBERS) + text[place.end() :]


def _swap_words(chance: random.Random, text: str, others: Sequence[str]) -> str:
    places, source = list(WORD.finditer(text)), list(WORD.finditer(chance.choice(others)))
    if not places or not source:
        return text
    place, word = chance.choice(places), chance.choice(source).group()
    return text[: place.start()] + word + text[place.end() :]


def _splice(chance: random.Random, text: str, others: Sequence[str]) -> str:
    other = chance.choice(others)
    start, end = _span(chance, other, 300)
    at = chance.randrange(len(text) + 1)
    return text[:at] + other[start:end] + text[at:]


def _flip_byte(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    at = chance.randrange(len(text) + 1)
    return text[:at] + chr(chance.randrange(1, 0x3000)) + text[at + 1 :]


def _nest(chance: random.Random, text: str, _others: Sequence[str]) -> str:
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice("([{~-") * chance.choice((3, 200, 5000)) + text[at:]


MUTATIONS = (_delete, _repeat, _insert_token, _break_number, _break_number, _swap_words, _splice, _flip_byte, _nest)


def mutated(chance: random.Random, text: str, others: Sequence[str]) -> str:
    """`text` with one to four things broken; `others` are texts to take pieces from."""
    for _ in range(chance.choice((1, 1, 2, 4))):
        text = chance.choice(MUTATIONS)(chance, text, others)
    return text
