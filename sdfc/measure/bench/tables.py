"""A run as tables: what is printed, and results.md."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sdfc.measure.bench.markdown import geometric_mean, number, table
from sdfc.measure.bench.plan import REFERENCE
from sdfc.measure.bench.record import Cell, Record, Spread
from sdfc.measure.bench.store import Store, ordered

LEGEND = f"""\
`ms`: median of the frames, drawn in turn with those of the other tracers, in brackets the quartiles. `x`: how many
times as fast as `{REFERENCE}` in the same rounds. `evals`, `steps`: values of the whole scene and passes of a ray's
loops, a pixel; `p99` of the steps. `wrong`: uncontested rays missed + hit falsely + answered before + behind where they
may be + not a number (what may be is that of tolerance 1). `cont.`: contested rays answered otherwise than certified.
`pixels`: |t - t*| in footprints of a pixel, median / 99th percentile / most. `normal`: degrees, 99th percentile off
creases. `stalls`: uncontested rays given up. `ready`: milliseconds from the scene to machine code."""

_HEAD = ("tracer", "ms", "x", "evals", "steps", "p99", "wrong", "cont.", "pixels", "normal", "stalls", "ready")


def page(store: Store) -> str:
    """All of a run, as Markdown."""
    parts = ["# sdfc bench", machine(store), LEGEND]
    records = ordered(store.records.values())
    for scene, size in dict.fromkeys((r.cell.scene, r.cell.size) for r in records):
        parts.append(f"## {scene}, {size}")
        here = [r for r in records if (r.cell.scene, r.cell.size) == (scene, size)]
        groups = dict.fromkeys((r.cell.tolerance, r.cell.budget) for r in here)
        for tolerance, budget in groups:
            group = [r for r in here if (r.cell.tolerance, r.cell.budget) == (tolerance, budget)]
            parts += [_title(tolerance, budget), table(_HEAD, map(row, group))]
            parts += [f"`{r.cell.tracer}` is {r.note}." for r in group if r.note]
    return "\n\n".join(parts) + "\n"


def machine(store: Store) -> str:
    """Where it was measured, as a list."""
    return "\n".join(f"- {name}: {value}" for name, value in (store.machine | store.settings).items())


def _title(tolerance: float, budget: int | None) -> str:
    limit = "" if budget is None else f", at most {budget} steps"
    return f"Tolerance {tolerance:g}{limit}:"


def row(record: Record) -> Sequence[str]:
    """A record's cells for `_HEAD`."""
    if record.illegal is not None:
        return (record.cell.tracer, f"illegal: {record.illegal}")
    t, w, b = record.timing, record.work, record.building
    grid = record.errors.get("grid")
    return (
        record.cell.tracer,
        "" if t is None else f"{number(t.median)} ({number(t.low)}..{number(t.high)})",
        "" if t is None else number(t.gain),
        "" if w is None else number(w.evaluations_mean),
        "" if w is None else number(w.steps_mean),
        "" if w is None else f"{w.steps_p99:.0f}",
        "" if not record.errors else _wrong(record),
        "" if not record.errors else str(sum(e.contested_wrong for e in record.errors.values())),
        "" if grid is None else spread(grid.pixels),
        "" if grid is None else number(grid.normals.p99, 2),
        "" if not record.errors else str(sum(e.stalls for e in record.errors.values())),
        "" if b is None else f"{b.compile + b.emit + b.front_end + b.first_draw:.0f}",
    )


def _wrong(record: Record) -> str:
    """`0`, or the four kinds with their sum."""
    found = record.errors.values()
    kinds = [sum(getattr(e, kind) for e in found) for kind in ("missed", "false", "early", "late", "not_finite")]
    return "0" if record.wrong == 0 else f"{record.wrong} = {' + '.join(map(str, kinds))}"


def spread(given: Spread) -> str:
    """Median / p99 / most."""
    return " / ".join(number(v, 2) for v in (given.median, given.p99, given.maximum))


def comparison(before: Store, after: Store) -> tuple[str, bool]:
    """Two runs side by side, and whether an error count grew on a cell that both have.

    Times are only shown: clocks are not steady enough to fail for.
    """
    both = [cell for cell in before.records if cell in after.records]
    measured = [c for c in both if before.records[c].timing is not None and after.records[c].timing is not None]
    rows = [_compared(cell, before.records[cell], after.records[cell]) for cell in _sorted(measured)]
    same = [c for c in measured if _judged(before.records[c]) == _judged(after.records[c])]
    worse = [c for c in same if after.records[c].wrong > before.records[c].wrong]
    lost = [c for c in both if before.records[c].illegal is None and after.records[c].illegal is not None]
    head = ("cell", "ms before", "ms after", "ratio", "p99 before", "p99 after", "wrong before", "wrong after")
    ratios = [_ratio(before.records[c], after.records[c]) for c in measured]
    parts = [
        table(head, rows),
        f"{len(measured)} cells in both; time after / before, geometric mean: {number(geometric_mean(ratios))}",
    ]
    parts += [f"{len(before.records) - len(both)} cells only before, {len(after.records) - len(both)} only after"]
    if len(same) < len(measured):
        parts.append(f"{len(measured) - len(same)} cells were judged by other rays: their errors are not held together")
    parts += [f"worse: {c}: {before.records[c].wrong} -> {after.records[c].wrong} wrong" for c in _sorted(worse)]
    parts += [f"no longer legal: {c}" for c in _sorted(lost)]
    return "\n\n".join(parts), bool(worse or lost)


def _judged(record: Record) -> dict[str, int]:
    """How many rays, by set."""
    return {name: e.rays + e.contested + e.ambiguous for name, e in record.errors.items()}


def _sorted(cells: Iterable[Cell]) -> list[Cell]:
    return sorted(cells, key=lambda c: c.order)


def _ratio(before: Record, after: Record) -> float:
    assert before.timing is not None and after.timing is not None
    return after.timing.median / before.timing.median


def _compared(cell: Cell, before: Record, after: Record) -> Sequence[str]:
    assert before.timing is not None and after.timing is not None
    times = (number(before.timing.median), number(after.timing.median), number(_ratio(before, after)))
    return (str(cell), *times, number(before.p99, 2), number(after.p99, 2), str(before.wrong), str(after.wrong))
