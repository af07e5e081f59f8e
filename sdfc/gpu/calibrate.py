"""How fast a device is at three small shaders: what the planner's predictions are scaled by (ALGORITHMS E)."""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass

from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram

SHADERS = ("frame", "formula", "table")
_SIDE = 256
_ROUNDS = 7
_ADDITIONS = 64.0 * (8.0 * 22.0 + 7.0 * 4.0 + 5.0)  # of formula.frag, in weighted operations
_ROWS = 256.0  # of table.frag


@dataclass(frozen=True, slots=True)
class Calibration:
    """Nanoseconds a pixel: a frame's own, a weighted operation of a formula, a row of a table."""

    frame: float
    addition: float
    row: float


def calibrate(device: Device, shaders: Mapping[str, str]) -> Calibration:
    """Draw each of SHADERS some times, in turn, and take the medians. The first draws, which compile, do not count."""
    programs = {name: FragmentProgram(device, shaders[name]) for name in SHADERS}
    taken: dict[str, list[float]] = {name: [] for name in SHADERS}
    with Frame(device, _SIDE, _SIDE) as frame:
        for _ in range(1 + _ROUNDS):
            for name, program in programs.items():
                started = time.perf_counter()
                frame.draw_whole(program, {})
                taken[name].append(time.perf_counter() - started)
    for program in programs.values():
        program.release()
    own, formula, table = (1e9 * statistics.median(taken[name][1:]) / _SIDE**2 for name in SHADERS)
    smallest = 1e-6  # a timer's grain: no speed is infinite
    return Calibration(own, max((formula - own) / _ADDITIONS, smallest), max((table - own) / _ROWS, smallest))
