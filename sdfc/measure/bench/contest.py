"""Frame times: all competitors in turn, A B C A B C, in one process, so that a slow moment of the machine hits all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from sdfc.measure.bench.answers import Answers
from sdfc.measure.bench.entrants import Drawing, Entrant, timed
from sdfc.measure.bench.record import Building, Timing, Work

PATIENCE = 1.5  # seconds of frames of one competitor; then no more are drawn
TINY = (16, 9)


@dataclass(frozen=True, slots=True)
class Start:
    """Milliseconds until a program could be drawn, and for its machine code."""

    front_end: float
    machine_code: float


def started(entrant: Entrant) -> Start:
    """Draws a tiny frame twice: the first is compiled for, the second is not."""
    with ExitStack() as stack:
        drawing, front_end = timed(lambda: stack.enter_context(entrant.drawing(TINY, 1.0)))
        first, second = timed(drawing.draw)[1], timed(drawing.draw)[1]
    return Start(front_end, max(0.0, first - second))


def frame_times(drawings: Mapping[str, Drawing], most: int, patience: float = PATIENCE) -> dict[str, list[float]]:
    """Milliseconds of every frame of each, one of each in turn.

    `most` frames of each, or fewer (one at least) where they have taken more than `patience` (seconds).
    """
    taken: dict[str, list[float]] = {name: [] for name in drawings}
    for _ in range(most):
        for name, drawing in drawings.items():
            if sum(taken[name]) <= 1e3 * patience:
                taken[name].append(timed(drawing.draw)[1])
    return taken


def timing(taken: Sequence[float], reference: Sequence[float]) -> Timing:
    """Of one competitor's frames, beside the reference's."""
    low, median, high = np.quantile(taken, [0.25, 0.5, 0.75])
    beside = float(np.median(reference)) if reference else float("nan")
    return Timing(float(median), float(low), float(high), len(taken), beside)


def building(entrant: Entrant, start: Start) -> Building:
    """What came before the first picture."""
    proving, printing = (entrant.costs.get(phase, 0.0) for phase in ("compile", "emit"))
    return Building(proving, printing, start.front_end, start.machine_code, len(entrant.text))


def work(answers: Answers) -> Work:
    """What a frame's rays took."""
    steps, evaluations = answers.steps, answers.evaluations
    return Work(
        float(steps.mean()),
        float(np.quantile(steps, 0.99, method="higher")),
        float(steps.max()),
        float(evaluations.mean()),
        float(np.quantile(evaluations, 0.99, method="higher")),
        float(answers.given_up.mean()),
    )
