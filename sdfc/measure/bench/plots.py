"""Plots, if matplotlib is there (`pip install 'sdfc[plots]'`); it is imported when the first is drawn."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sdfc.image.write import write

ADVICE = "no plots: matplotlib is not installed (pip install 'sdfc[plots]')"
_said: set[str] = set()


def are_there(note: Callable[[str], None]) -> bool:
    """Whether plots can be drawn; where not, it is said once."""
    if importlib.util.find_spec("matplotlib") is not None:
        return True
    if ADVICE not in _said:
        _said.add(ADVICE)
        note(ADVICE)
    return False


def heat(path: Path, title: str, picture: NDArray[np.uint8], maps: Mapping[str, NDArray[np.float64]]) -> None:
    """A picture beside maps of counts (height, width), on one logarithmic scale."""
    from matplotlib.colors import LogNorm

    figure, axes = _figure(1, 1 + len(maps), 4.0, 2.6)
    axes[0].imshow(picture)
    axes[0].set_title(title, fontsize=9)
    most = max(2.0, *(float(m.max()) for m in maps.values()))
    for axis, (name, steps) in zip(axes[1:], maps.items(), strict=True):
        shown = axis.imshow(np.maximum(steps, 1.0), norm=LogNorm(1.0, most), cmap="inferno")
        axis.set_title(f"{name}: {steps.mean():.1f} steps a pixel", fontsize=9)
    for axis in axes:
        axis.set_axis_off()
    figure.colorbar(shown, ax=list(axes), fraction=0.02, pad=0.01)
    save(figure, path)


def _figure(rows: int, columns: int, width: float, height: float) -> tuple[Any, Any]:
    """A figure and its axes as a flat array; inches an axis. No window system is asked for."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(columns * width, rows * height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()


def save(figure: Any, path: Path) -> None:
    """As PNG, whole or not at all, and without a date: the same numbers make the same file."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=80, metadata={"Software": None})
    write(path, data.getvalue())
