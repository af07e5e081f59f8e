"""The progress bar."""

from __future__ import annotations

import io

import pytest

from sdfc.cli import progress
from sdfc.cli.progress import ProgressBar, duration


class Terminal(io.StringIO):
    """A stream that a person looks at."""

    def isatty(self) -> bool:
        return True


class Clock:
    """Time that passes when it is told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(progress, "time", made)
    return made


def test_it_is_silent_in_the_first_second_then_says_the_time_left(clock: Clock) -> None:
    stream = Terminal()
    with ProgressBar("rendering", stream) as bar:
        clock.now += 0.9
        bar(0.1)
        assert stream.getvalue() == ""
        clock.now += 1.1
        bar(0.25)
        assert "25%  0:06 left" in stream.getvalue()
    assert stream.getvalue().endswith("\r\x1b[K"), "it clears its line"


def test_it_is_silent_in_a_pipe(clock: Clock) -> None:
    stream = io.StringIO()
    with ProgressBar("rendering", stream) as bar:
        clock.now += 10.0
        bar(0.5)
    assert stream.getvalue() == ""


def test_durations() -> None:
    assert [duration(s) for s in (None, 0.4, 7, 61.2, 3723)] == ["?", "0:00", "0:07", "1:01", "1:02:03"]
