"""A picture of every scene beside where its steps are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sdfc.api.renderer import Shot
from sdfc.api.request import View
from sdfc.measure.bench import plots
from sdfc.measure.bench.competition import Competition
from sdfc.measure.bench.entrants import Illegal, Traced
from sdfc.measure.bench.plan import OWN, REFERENCE
from sdfc.shade.present import present

SIZE = (320, 180)  # of each of the pictures


def draw(competition: Competition, folder: Path, note: Callable[[str], None]) -> None:
    """STEM.steps.png in the folder, if it is not there yet: the picture, and the steps of two tracers on one scale."""
    path = folder / f"{Path(competition.name).stem}.steps.png"
    names = [n for n in (REFERENCE, OWN) if n in competition.wanted.tracers]
    if path.exists() or not names or not plots.are_there(note):
        return
    maps = {name: found for name in names if (found := _steps(competition, name)) is not None}
    if maps:
        plots.heat(path, competition.name, _picture(competition), maps)


def _steps(competition: Competition, name: str) -> NDArray[np.float64] | None:
    """Passes of the loops, (height, width)."""
    match competition.competitor(name):
        case Traced() as legal:
            with legal.drawing(SIZE, 1.0) as drawing:
                drawing.draw()
                steps: NDArray[Any] = drawing.read()[..., 1]
                return steps.astype(np.float64)
        case Illegal() | _:
            return None


def _picture(competition: Competition) -> NDArray[np.uint8]:
    """As a screen shows it."""
    compiled = competition.base
    match competition.competitor(OWN):
        case Traced() as legal:
            compiled = legal.compiled
        case _:
            pass
    return present(competition.renderer.radiance(Shot(compiled, View(), {}, SIZE), 0, None)[..., :3])
