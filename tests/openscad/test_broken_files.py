"""Files that somebody damaged: whatever they say, the answer is a scene or errors with places. Seeded: repeatable."""

import random
import re
from pathlib import Path

import pytest

from sdfc.diagnostics import SceneError, Source, show_all
from sdfc.openscad.load import load
from sdfc.openscad.modules import MODULES

TEXTS = [path.read_text() for path in sorted((Path(__file__).parent / "models").glob("*.csg"))]
NUMBERS = (
    "inf",
    "-nan",
    "0",
    "1e308",
    "-1e308",
    "1e-308",
    "-1",
    "1e400",
    "undef",
    "true",
    '"x"',
    "[]",
    "[[1, 2]]",
    "3",
)
SOUP = ("{", "}", "(", ")", "[", "]", ";", ",", "=", "%", "!", "*", "#", "//", "/*", '"', "$fn = 3", "cube(1);", "\0")


def damaged(chance: random.Random) -> str:
    text = chance.choice(TEXTS)
    for _ in range(chance.choice((1, 1, 2, 5))):
        at = chance.randrange(len(text) + 1)
        match chance.randrange(5):
            case 0:
                text = text[:at] + chance.choice(SOUP) + text[at:]
            case 1:
                text = text[:at] + text[at + chance.randrange(1, 12) :]
            case 2:
                text = _exchanged(chance, text, r"-?\d[\d.e+-]*", NUMBERS)
            case 3:
                text = _exchanged(chance, text, r"\b[a-z_]{3,}\b(?= ?\()", tuple(MODULES))
            case _:
                text = _exchanged(chance, text, r"\b[a-z_0-9]+\b(?= =)", ("r", "h", "$fn", "size", "points", "scale"))
    return text


def _exchanged(chance: random.Random, text: str, pattern: str, choices: tuple[str, ...]) -> str:
    found = list(re.finditer(pattern, text))
    if not found:
        return text
    place = chance.choice(found)
    return text[: place.start()] + chance.choice(choices) + text[place.end() :]


@pytest.mark.parametrize("seed", range(8))
def test_damage_is_a_scene_or_errors_with_places(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(60):
        text = damaged(chance)
        try:
            load(Source("m.csg", text))
        except SceneError as error:
            assert all(d.span is not None for d in error.diagnostics), text
            assert "m.csg:" in show_all(error.diagnostics)
