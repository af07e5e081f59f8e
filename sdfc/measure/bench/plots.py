"""Plots, if matplotlib is there (`pip install 'sdfc[plots]'`); it is imported when the first is drawn."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Callable, Hashable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sdfc.image.write import write
from sdfc.measure.bench.plan import FLOOR, FOREIGN, OMEGAS, REFERENCE
from sdfc.measure.bench.record import Record
from sdfc.measure.bench.store import Store, ordered

Key = TypeVar("Key", bound=Hashable)

ADVICE = "no plots: matplotlib is not installed (pip install 'sdfc[plots]')"


def are_there(note: Callable[[str], None]) -> bool:
    """Whether plots can be drawn; where not, it is said."""
    found = importlib.util.find_spec("matplotlib") is not None
    if not found:
        note(ADVICE)
    return found


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

    figure = Figure(figsize=(max(6.4, columns * width), rows * height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()


def save(figure: Any, path: Path) -> None:
    """As PNG, whole or not at all, and without a date: the same numbers make the same file."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=80, metadata={"Software": None})
    write(path, data.getvalue())


def all_of(store: Store, folder: Path) -> None:
    """Every plot that there are records for."""
    made = {
        "time-error.png": time_against_error,
        "budgets.png": error_against_budget,
        "ratios.png": ratios,
        "omega.png": omegas,
    }
    for name, draw in made.items():
        figure = draw(ordered(store.records.values()))
        if figure is not None:
            save(figure, folder / name)


def time_against_error(records: list[Record]) -> Any:
    """A panel a scene: each tracer's tolerances, p99 error to the right, time upwards; the Pareto front in black."""
    places = _compared(records)
    plain = [r for r in records if r.timing is not None and r.p99 > 0.0 and _is_plain(r)]
    plain = [r for r in plain if r.cell.budget is None and (r.cell.scene, r.cell.size) in places]
    if not plain:
        return None
    figure, axes = _panels({(r.cell.scene, r.cell.size): None for r in plain})
    for (scene, size), axis in axes.items():
        here = [r for r in plain if (r.cell.scene, r.cell.size) == (scene, size)]
        for name in dict.fromkeys(r.cell.tracer for r in here):
            mine = [r for r in here if r.cell.tracer == name]
            _line(axis, name, [r.p99 for r in mine], [_ms(r) for r in mine])
        front = pareto([(r.p99, _ms(r)) for r in here])
        axis.step(*zip(*front, strict=True), where="post", color="black", linewidth=2.5, alpha=0.25, zorder=0)
        _axes(axis, f"{scene} {size}", "p99 error, pixels", "ms a frame")
        axis.set_xscale("log")
        axis.set_yscale("log")
    return _with_legend(figure, axes.values())


def error_against_budget(records: list[Record]) -> Any:
    """Two panels a scene: mean error and time by the most steps a ray may take (Balint & Kiglics 2021, figure 6)."""
    some = [r for r in records if r.cell.budget is not None and r.timing is not None and _is_plain(r)]
    scenes = {(r.cell.scene, r.cell.size): None for r in some if "grid" in r.errors}
    if not scenes:
        return None
    figure, axes = _panels(
        {(*scene, kind): None for scene in scenes for kind in ("mean error, pixels", "ms a frame")}, 2
    )
    for (scene, size, kind), axis in axes.items():
        here = [r for r in some if (r.cell.scene, r.cell.size, r.cell.tolerance) == (scene, size, 1.0)]
        for name in dict.fromkeys(r.cell.tracer for r in here):
            mine = sorted((r for r in here if r.cell.tracer == name), key=lambda r: r.cell.budget or 0)
            values = [_ms(r) if kind == "ms a frame" else r.errors["grid"].mean_pixels for r in mine]
            _line(axis, name, [float(r.cell.budget or 0) for r in mine], values)
        _axes(axis, f"{scene} {size}", "most steps a ray", kind)
        axis.set_xscale("log", base=2)
        axis.set_yscale("log")
    return _with_legend(figure, axes.values())


def ratios(records: list[Record]) -> Any:
    """How many times as fast as the reference each tracer is, by scene, at tolerance 1."""
    compared = _compared(records)
    some = [r for r in records if r.cell.budget is None and r.cell.tolerance == 1.0 and r.work and _is_plain(r)]
    some = [r for r in some if (r.cell.scene, r.cell.size) in compared]
    rows = list(dict.fromkeys(f"{r.cell.scene} {r.cell.size}" for r in some))
    if not rows:
        return None
    figure, (axis,) = _figure(1, 1, 8.0, 1.2 + 0.32 * len(rows))
    for name in dict.fromkeys(r.cell.tracer for r in some):
        mine = [r for r in some if r.cell.tracer == name and r.timing is not None]
        places = [rows.index(f"{r.cell.scene} {r.cell.size}") for r in mine]
        speeds = [r.timing.gain for r in mine if r.timing is not None]
        axis.plot(speeds, places, linestyle="", **_style(name))
    axis.set_yticks(range(len(rows)), rows, fontsize=7)
    axis.axvline(1.0, color="grey", linewidth=0.8)
    axis.invert_yaxis()
    _axes(axis, "", f"times as fast as {REFERENCE}", "")
    axis.set_xscale("log")
    return _with_legend(figure, [axis])


def omegas(records: list[Record]) -> Any:
    """Evaluations a pixel by omega, of the tracer `relaxed` (Keinert et al. 2014, section 5)."""
    some = [r for r in records if r.cell.budget is None and r.cell.tracer in OMEGAS]
    groups = dict.fromkeys((r.cell.scene, r.cell.size, r.cell.tolerance) for r in some)
    if len(some) <= len(groups):  # nothing was swept
        return None
    figure, (axis,) = _figure(1, 1, 5.0, 3.4)
    for scene, size, tolerance in groups:
        here = [r for r in some if (r.cell.scene, r.cell.size, r.cell.tolerance) == (scene, size, tolerance)]
        line = sorted((OMEGAS[r.cell.tracer], r.work.evaluations_mean) for r in here if r.work is not None)
        if len(line) > 1:
            name = f"{scene} {size}, tolerance {tolerance:g}"
            axis.plot(*zip(*line, strict=True), marker="o", markersize=3, linewidth=1, label=name)
    _axes(axis, "relaxed", "omega", "evaluations a pixel")
    axis.set_yscale("log")
    axis.legend(fontsize=6)
    return figure


def pareto(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Those that no other is better than in both, from the smallest first value on."""
    front: list[tuple[float, float]] = []
    for point in sorted(points):
        if not front or point[1] < front[-1][1]:
            front.append(point)
    return front


def _compared(records: list[Record]) -> set[tuple[str, str]]:
    """The scenes and sizes at which all tracers were compared."""
    return {(r.cell.scene, r.cell.size) for r in records if r.cell.tracer == FLOOR}


def _is_plain(record: Record) -> bool:
    """Not one of a parameter's sweep."""
    return ":" not in record.cell.tracer or record.cell.tracer.startswith(FOREIGN)


def _ms(record: Record) -> float:
    return np.nan if record.timing is None else record.timing.median


def _panels(keys: Mapping[Key, None], columns: int = 4) -> tuple[Any, dict[Key, Any]]:
    """A figure with an axis for each key."""
    columns = min(columns, len(keys))
    rows = -(-len(keys) // columns)
    figure, axes = _figure(rows, columns, 3.2, 2.4)
    for axis in axes[len(keys) :]:
        axis.set_visible(False)
    return figure, dict(zip(keys, axes, strict=False))


def _line(axis: Any, name: str, x: list[float], y: list[float]) -> None:
    axis.plot(x, y, linewidth=1, **_style(name))


_MARKERS = "osD^vP*X<>hp"
_styles: dict[str, dict[str, Any]] = {}


def _style(name: str) -> dict[str, Any]:
    """The same for a tracer in every plot of a process."""
    if name not in _styles:
        count = len(_styles)
        _styles[name] = {"color": f"C{count % 10}", "marker": _MARKERS[count % len(_MARKERS)], "markersize": 4}
    return {**_styles[name], "label": name}


def _axes(axis: Any, title: str, x: str, y: str) -> None:
    axis.set_title(title, fontsize=8)
    axis.set_xlabel(x, fontsize=7)
    axis.set_ylabel(y, fontsize=7)
    axis.tick_params(labelsize=6)
    axis.grid(alpha=0.3, linewidth=0.5)


def _with_legend(figure: Any, axes: Iterable[Any]) -> Any:
    """One legend for all axes, above them."""
    handles = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    columns = int(figure.get_figwidth() / 1.6)
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=columns, fontsize=7)
    return figure
