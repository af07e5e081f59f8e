"""docs/benchmarks.md: what a run found, in words and tables, made from its file of results and nothing else."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from sdfc.measure.bench import findings
from sdfc.measure.bench.markdown import geometric_mean, number, table
from sdfc.measure.bench.plan import FLOOR, REFERENCE
from sdfc.measure.bench.record import Record
from sdfc.measure.bench.results import PUBLISHED, Results, Row, speed_up
from sdfc.measure.bench.store import RESULTS, Store
from sdfc.measure.bench.tables import LEGEND, machine

_PLOTS = (
    ("time-error.png", "Time against p99 error of every tracer at every tolerance; the grey line is the Pareto front."),
    ("ratios.png", "How many times as fast as `sphere`, by scene."),
)


def report(store: Store, folder: Path, page: Path) -> str:
    """The page, with links as they are from where it is kept (`-`: from here)."""
    results = Results(store)
    where = Path(os.path.relpath(folder, page.parent))
    parts = [
        *_opening(store, folder, page),
        *_times(results),
        *_errors(results),
        *_worst(results),
        *_planner(results),
        *_building(results),
    ]
    parts += [*findings.budgets(results), *findings.keinert(results)]
    pictures = [*_PLOTS, *findings.PLOTS, *((p.name, p.name) for p in sorted(folder.glob("*.steps.png")))]
    shown = [f"![{text}]({(where / name).as_posix()})" for name, text in pictures if (folder / name).exists()]
    return "\n\n".join([*parts, *(["## Pictures", *shown] if shown else [])]) + "\n"


def _opening(store: Store, folder: Path, page: Path) -> Iterator[str]:
    command = f"sdfc bench --report {folder.as_posix()} -o {page.as_posix()}"
    where = Path(os.path.relpath(folder, page.parent))
    readme = folder.parent.parent / "README.md"  # of bench/
    link = Path(os.path.normpath(where / ".." / ".." / "README.md")).as_posix()
    more = (
        f" [bench/README.md]({link}) says how to measure, and how to enter your own shader." if readme.exists() else ""
    )
    yield f"<!-- made by: {command} -->"
    yield "# Benchmarks"
    yield (
        f"Made from [{folder.name}]({(where / RESULTS).as_posix()}) by `{command}`. Times are of primary rays "
        "only (a depth image). Tolerance 1 is what sdfc asks for, a 64th of half a pixel or 16 roundings. Errors are "
        f"against certified truth.{more}"
    )
    yield machine(store)
    yield LEGEND


def _times(results: Results) -> Iterator[str]:
    """The ratios that the project is held to."""
    yield "## Time at no larger error"
    ours = results.ours
    yield (
        f"`{ours}` beside `{REFERENCE}` and the fastest published tracer ({', '.join(f'`{n}`' for n in PUBLISHED)}), "
        "at tolerance 1. A ratio is given where ours has no larger p99 error (by 2 %) and no more wrong rays, at "
        "the same tolerance or, where that is not so, at a finer one that was measured. The best is the fastest of "
        "those that lose the fewest rays; to be early is no loss."
    )
    rows, ratios = [], []
    for row in results.rows:
        three = row.at(REFERENCE), row.best(PUBLISHED), row.at(ours)
        ratios.append((speed_up(row, three[0], ours), speed_up(row, three[1], ours)))
        rows.append(_time_row(row, three, ratios[-1]))
    columns = list(zip(*ratios, strict=True))
    rows.append(("**geometric mean**", *[""] * 5, *(number(geometric_mean(column)) for column in columns)))
    times = ("scene", f"{FLOOR} ms", f"{REFERENCE} ms", "best ms", "best", f"{ours} ms")
    head = (*times, f"{REFERENCE} / {ours}", f"best / {ours}", f"p99 {REFERENCE}", "p99 best", f"p99 {ours}")
    yield table((*head, f"lost {REFERENCE}", "lost best", f"lost {ours}"), rows)
    for words, column in zip((f"`{REFERENCE}`", "the best"), columns, strict=True):
        given = [(ratio, row.name) for ratio, row in zip(column, results.rows, strict=True) if ratio == ratio]
        least = f"; the least is {number(min(given)[0])} ({min(given)[1]})" if given else ""
        yield f"Beside {words} a ratio could be given on {len(given)} of {len(results.rows)} scenes{least}."


def _time_row(row: Row, three: Sequence[Record | None], ratios: Sequence[float]) -> Sequence[str]:
    floor, best = row.at(FLOOR), three[1]
    ms = ["-" if r is None or r.timing is None else number(r.timing.median) for r in (floor, *three)]
    ms.insert(3, "-" if best is None else f"`{best.cell.tracer}`")
    return (
        row.name,
        *ms,
        *map(number, ratios),
        *("-" if r is None else number(r.p99, 2) for r in three),
        *("-" if r is None else str(r.lost) for r in three),
    )


def _building(results: Results) -> Iterator[str]:
    """From the scene to its first picture."""
    ours = results.ours
    yield "## From scene to picture"
    yield (
        f"Milliseconds for `{ours}`: proving and planning, printing, the driver's GLSL front end, and machine code "
        "(the first frame, which is tiny, less the second), with Mesa's cache switched off. Of the others the last two "
        "summed."
    )
    others = [name for name in results.tracers if name != ours]
    rows = []
    for row in results.rows:
        mine = row.at(ours)
        if mine is None or mine.building is None:
            continue
        b = mine.building
        found = [row.at(name) for name in others]
        drivers = [f"{r.building.front_end + r.building.first_draw:.0f}" if r and r.building else "-" for r in found]
        phases = (f"{value:.0f}" for value in (b.compile, b.emit, b.front_end, b.first_draw))
        rows.append((row.name, str(b.length), *phases, *drivers))
    head = ("scene", "characters of GLSL", "proving", "printing", "front end", "machine code")
    yield table((*head, *(f"`{name}`" for name in others)), rows)


def _errors(results: Results) -> Iterator[str]:
    """What is wrong, by tracer, over all scenes."""
    yield "## Errors at tolerance 1, over all scenes"
    yield (
        "A hit is early before what twice the tolerance at the scene's far side allows. On a floor that goes on behind "
        "the scene a marcher's tolerance grows with the distance: it is early there by its own rule, and p99 tells by "
        "how much."
    )
    rows = []
    for name in results.tracers:
        found = [(row, r) for row in results.rows if (r := row.at(name)) is not None and r.errors]
        if not found:
            continue
        sums = [
            sum(getattr(e, kind) for _, r in found for e in r.errors.values())
            for kind in ("rays", "missed", "false", "early", "late", "not_finite", "stalls", "contested_wrong")
        ]
        p99 = max(found, key=lambda f: _or_zero(f[1].p99))
        most = max(found, key=lambda f: _or_zero(f[1].errors["grid"].pixels.maximum))
        normal = max(_or_zero(r.errors["grid"].normals.p99) for _, r in found)
        rows.append(
            (
                f"`{name}`",
                str(len(found)),
                *map(str, sums),
                f"{number(p99[1].p99, 2)} ({p99[0].name})",
                f"{number(most[1].errors['grid'].pixels.maximum, 2)} ({most[0].name})",
                number(normal, 2),
            )
        )
    head = ("tracer", "scenes", "rays", "missed", "false", "early", "late", "NaN", "stalls", "contested wrong")
    yield table((*head, "worst p99, pixels", "worst, pixels", "worst p99 of normals, degrees"), rows)
    refused = [f"- `{name}` on {row.name}: {why}" for row in results.rows for name, why in row.illegal.items()]
    if refused:
        yield "Not legal:\n\n" + "\n".join(refused)


def _or_zero(value: float) -> float:
    return value if value == value else 0.0


def _worst(results: Results) -> Iterator[str]:
    """The worst of each kind, of ours."""
    ours = results.ours
    found = [(row, r) for row in results.rows if (r := row.at(ours)) is not None and r.errors and r.timing and r.work]
    if not found:
        return
    yield f"## Worst cases of `{ours}`"
    least, gain = min(((row, r.timing.gain) for row, r in found if r.timing), key=lambda f: f[1])
    lines = [_line(least, f"the least gain over `{REFERENCE}`", gain)]
    for words, value in findings.WORST.items():
        row, record = max(found, key=lambda f: _or_zero(value(f[1])))
        lines.append(_line(row, words, value(record)))
    yield "\n".join(lines)


def _line(row: Row, words: str, value: float) -> str:
    return f"- {words}: {number(value)} ({row.name})"


def _planner(results: Results) -> Iterator[str]:
    """How good the choice is."""
    ours = results.ours
    yield f"## How good the choice is (`{ours}`)"
    rows, best_count, close = [], 0, 0
    for row in results.rows:
        mine, best = row.at(ours), row.best(results.tracers)
        if mine is None or best is None or mine.timing is None or best.timing is None:
            continue
        share = best.timing.median / mine.timing.median
        best_count += share == 1.0
        close += share >= 1 / 1.1
        rows.append((row.name, mine.note or ours, f"`{best.cell.tracer}`", number(share)))
    yield table(("scene", "chosen", "fastest of all", "time of the fastest / of the chosen"), rows)
    yield (
        f"It was the fastest on {best_count} of {len(rows)} scenes, and within 10 % of the fastest on {close}; the "
        "fastest is of the tracers that lose no more rays."
    )
