"""Errors as a user reads them, word for word."""

import pytest
from language_corpus import cases
from language_scenes import errors


@pytest.mark.parametrize(("source", "expected"), cases("errors.txt"))
def test_what_is_wrong_with_a_scene(source: str, expected: str) -> None:
    assert errors(source) == expected


@pytest.mark.parametrize(("source", "expected"), cases("syntax_errors.txt"))
def test_what_is_wrong_with_a_text(source: str, expected: str) -> None:
    assert errors(source) == expected


def test_at_most_fifty_errors_are_looked_for() -> None:
    text = "scene { " + " ".join(f"unknown{i}" for i in range(1000)) + " }"
    assert errors(text).endswith("... and 30 more")
