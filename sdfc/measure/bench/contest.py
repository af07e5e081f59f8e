"""Frame times: all competitors in turn, A B C A B C, in one process, so that a slow moment of the machine hits all."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sdfc.measure.bench.answers import Answers
from sdfc.measure.bench.entrants import Drawing, timed
from sdfc.measure.bench.record import Building, Timing, Work

PATIENCE = 8.0  # seconds of rounds; then no more are begun


@dataclass(frozen=True, slots=True)
class FirstDraw:
    """Milliseconds that a program took until it could be drawn, and to be drawn for the first time."""

    front_end: float
    draw: float


def frame_times(drawings: Mapping[str, Drawing], most: int, patience: float = PATIENCE) -> dict[str, list[float]]:
    """Milliseconds of every frame of each. `most` rounds, or fewer (one at least) that take `patience` (seconds)."""
    taken: dict[str, list[float]] = {name: [] for name in drawings}
    started = time.perf_counter()
    for done in range(most):
        if done and time.perf_counter() - started > patience:
            break
        for name, drawing in drawings.items():
            taken[name].append(timed(drawing.draw)[1])
    return taken


def timing(taken: Sequence[float], reference: Sequence[float]) -> Timing:
    """Of one competitor's frames, beside the reference's."""
    low, median, high = np.quantile(taken, [0.25, 0.5, 0.75])
    beside = float(np.median(reference)) if reference else float("nan")
    return Timing(float(median), float(low), float(high), len(taken), beside)


def building(costs: Mapping[str, float], first: FirstDraw, frame: float, length: int) -> Building:
    """What came before the first picture; milliseconds, all but `length`. `frame`: what later frames took."""
    slower = max(0.0, first.draw - frame)
    return Building(costs.get("compile", 0.0), costs.get("emit", 0.0), first.front_end, slower, length)


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
