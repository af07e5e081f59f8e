"""Which literals are live, in which ranges, and under which names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sdfc.live.snapshot import Key, Snapshot
from sdfc.live.text import Literal, kept
from sdfc.scene.literals import Literals, LiveLiteral

Live = Mapping[Key, LiveLiteral]
"""Live literals, those first that were touched longest ago."""


def ranges(old: Literal, new: Literal) -> list[tuple[float, float]]:
    """Ranges for a literal that was changed, the widest first: what is proved of the scene holds in all of it.

    A literal has no sign (that is a word of its own), and its neighbours may forbid what lies beyond 1, or beyond it.
    """
    if new.unit == "color":
        return [(0.0, 1.0)]
    low, high = sorted((old.value[0], new.value[0]))
    whole = [(low / 2, high * 2), (low / 2, 1.0), (low / 2, high), (low, high)]
    return list(dict.fromkeys((a, b) for a, b in whole if a < b and b >= high))


def is_within(literal: Literal, live: LiveLiteral) -> bool:
    """Whether the literal's value is one that its live name may have."""
    return all(live.low <= number <= live.high for number in literal.value)


def places(live: Live, snapshot: Snapshot) -> Literals:
    """The live literals as the compiler asks for them: by where they stand."""
    return {(key[0], snapshot.literal(key).start): made for key, made in live.items()}


def carried(live: Live, before: Snapshot, after: Snapshot) -> dict[Key, LiveLiteral]:
    """The live literals that an edit of the structure left in their places, and in their ranges."""
    found: dict[Key, LiveLiteral] = {}
    tables: dict[str, Mapping[int, int]] = {}
    for (name, index), made in live.items():
        if name not in after.texts:
            continue
        old, new = before.texts[name], after.texts[name]
        if name not in tables:
            tables[name] = kept(old.words, new.words)
        by_word = {literal.word: i for i, literal in enumerate(new.literals)}
        now = by_word.get(tables[name].get(old.literals[index].word, -1))
        if now is not None and is_within(new.literals[now], made):
            found[name, now] = made
    return found


def names(count: int, texts: Sequence[str], taken: Live) -> Iterator[str]:
    """Names for live literals that no text has, `count` of them and those that are in use among them."""
    prefix = "literal"
    while any(prefix in text for text in texts):
        prefix += "x"
    used = {made.name for made in taken.values()}
    yield from (name for name in (f"{prefix}_{i}" for i in range(1, count + 1)) if name not in used)
