"""What was done for a save, and how long it took."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from enum import Enum

from sdfc.diagnostics import Diagnostic


class Speed(Enum):
    """What an edit cost: from nothing to a shader that the driver has not seen."""

    NOTHING = "nothing to draw"
    NUMBERS = "numbers"
    CAMERA = "camera"
    SAME_SHADER = "same shader"
    NEW_SHADER = "new shader"


@dataclass(frozen=True, slots=True)
class Update:
    """What was done for a save. Times in milliseconds, by what took them."""

    speed: Speed
    times: dict[str, float]
    live: int  # literals that are uniforms now
    warnings: tuple[Diagnostic, ...] = ()

    @property
    def milliseconds(self) -> float:
        return sum(self.times.values())


@dataclass(slots=True)
class Stopwatch:
    """Time since the last look, in milliseconds, by what took it."""

    times: dict[str, float] = field(default_factory=dict)
    since: float = field(default_factory=time.perf_counter)

    def took(self, what: str) -> None:
        now = time.perf_counter()
        self.times[what] = self.times.get(what, 0.0) + 1e3 * (now - self.since)
        self.since = now
