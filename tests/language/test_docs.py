"""Every example of docs/language.md is a scene without errors or warnings about what it uses."""

import re
from pathlib import Path

import pytest
from language_scenes import errors, scene

from sdfc.diagnostics import SceneError
from sdfc.scene import limits
from sdfc.scene.combine import OPERATIONS
from sdfc.scene.functions import CONSTANTS, FOLDS, FUNCTIONS
from sdfc.scene.transforms import TRANSFORMS
from sdfc.shape.definition import Exactness, Kind
from sdfc.syntax.mistakes import STATEMENTS

PAGE = (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8")
FENCES = re.findall(r"^```(\w+)(?: file=(\S+))?\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
EXAMPLES = [text for kind, file, text in FENCES if kind == "sdf" and not file]
FILES = {file: text for _, file, text in FENCES if file}


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 9 and len(FILES) == 2


@pytest.mark.parametrize("text", EXAMPLES, ids=range(len(EXAMPLES)))
def test_an_example_is_a_scene(text: str, tmp_path: Path) -> None:
    for name, content in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(content)
    try:
        made = scene(text, tmp_path)
    except SceneError:
        pytest.fail(errors(text, tmp_path))
    assert not made.warnings


def test_the_error_shown_is_the_one_that_there_is() -> None:
    (shown,) = re.findall(r"^```\n(die\.sdf.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    try:
        scene("\n" * 10 + "scene {\n    sphere(radus: 0.1)\n}\n", name="die.sdf")
    except SceneError as error:
        from sdfc.diagnostics import show_all

        assert show_all(error.diagnostics) + "\n" == shown


@pytest.mark.parametrize(
    "word", [*STATEMENTS, *FUNCTIONS, *FOLDS, *CONSTANTS, *OPERATIONS, *TRANSFORMS, *[k.value for k in Kind], "count"]
)
def test_every_word_of_the_language_is_explained(word: str) -> None:
    assert re.search(rf"[`\s.(]{word}[`\s(:,]", PAGE)


def test_every_claim_and_limit_is_explained() -> None:
    for exactness in set(Exactness) - {Exactness.NONE}:
        assert f"`{exactness.value}`" in PAGE
    for limit in (limits.MOST_SHAPES, limits.MOST_STEPS, limits.LARGEST_FILE, limits.LONGEST_LIST, limits.MOST_FILES):
        assert f"{limit:,}".replace(",", " ") in PAGE
