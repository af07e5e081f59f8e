"""Cases kept as text: a scene, a line of dashes, what a user reads; cases are parted by lines of equals signs."""

from __future__ import annotations

from pathlib import Path


def cases(name: str) -> list[tuple[str, str]]:
    """(scene, expected text) of each case in a file beside this one."""
    text = (Path(__file__).parent / name).read_text(encoding="utf-8")
    found = []
    for part in text.split("\n====\n"):
        source, _, expected = part.partition("\n----\n")
        found.append((source.strip("\n"), expected.strip("\n")))
    return found
