"""How much a scene may ask of the compiler: each limit has its own error, and no input hangs."""

from __future__ import annotations

from sdfc.diagnostics import Diagnostic, SceneError, Span

MOST_SHAPES = 100_000  # after loops, calls and tables are expanded
MOST_STEPS = 500_000  # rounds of loops and calls of functions
LONGEST_LOOP = 100_000
LONGEST_LIST = 1_000  # given to one field: each element is printed in the shader
MOST_ROWS = 100_000  # of a CSV
LARGEST_NUMBER = 1e12  # in size, of what is given to anything: products of a few stay within float32
LARGEST_FILE = 4 * 2**20  # bytes, of any file that is read
MOST_FILES = 100
MOST_PROBLEMS = 50  # that are looked for
DEEPEST_FRAMES = 60_000  # Python's own, while a scene is expanded


class LimitError(SceneError):
    """A limit was passed: there is no going on to look for other errors."""


class Budget:
    """What is left to one elaboration."""

    __slots__ = ("is_over", "shapes", "steps")

    def __init__(self) -> None:
        self.is_over = False  # the scene is there: what is evaluated from now on is no longer counted
        self.shapes = 0
        self.steps = 0

    def shape(self, span: Span) -> None:
        """One more shape."""
        self.shapes += 1
        if self.shapes > MOST_SHAPES:
            raise LimitError(Diagnostic(f"the scene has more than {MOST_SHAPES} shapes once it is expanded", span))

    def step(self, span: Span | None) -> None:
        """One more round of a loop, call, or value tried."""
        self.steps += 1
        if self.steps > MOST_STEPS and not self.is_over:
            message = f"more than {MOST_STEPS} calls and rounds of loops are needed to expand the scene"
            raise LimitError(Diagnostic(message, span))
