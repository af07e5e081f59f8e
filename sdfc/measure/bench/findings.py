"""What others have published, measured again: error against a budget of steps, and Keinert's relaxation."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from sdfc.measure.bench.markdown import number, table
from sdfc.measure.bench.plan import FORCED, HALF_PIXEL, KEINERT_STEPS, OMEGAS, REFERENCE
from sdfc.measure.bench.record import Record
from sdfc.measure.bench.results import Results, Row

PLOTS = (
    ("budgets.png", "Error and time by the most steps that a ray may take."),
    ("omega.png", "Evaluations a pixel by omega."),
)
WORST: dict[str, Callable[[Record], float]] = {
    "the largest p99 error, in pixels": lambda r: r.p99,
    "the largest error, in pixels": lambda r: r.errors["grid"].pixels.maximum,
    "the largest error, in float32 ulps": lambda r: r.errors["grid"].ulps.maximum,
    "the most steps of a ray": lambda r: r.work.steps_max if r.work else 0.0,
    "the most wrong rays": lambda r: float(r.wrong),
    "the longest from scene to machine code, in ms": lambda r: ready(r),
}
TABLE_1 = 32  # the steps of their table
KEINERT = {"city.sdf": 20.409 / 16.829, "jewel.sdf": 3.472 / 2.978}  # his times, plain by relaxed at omega 1.2


def ready(record: Record) -> float:
    """Milliseconds from the scene's graph to machine code."""
    b = record.building
    return 0.0 if b is None else b.compile + b.emit + b.front_end + b.first_draw


def budgets(results: Results) -> Iterator[str]:
    """Table 1 of Balint & Kiglics (2021), with certified truth in the place of a thousand steps of the same method."""
    rows = []
    for row in results.places:
        first = row.at(REFERENCE, budget=TABLE_1)
        if first is None or not first.errors:
            continue
        base = first.errors["grid"].mean_pixels
        for name in results.tracers:
            found = row.at(name, budget=TABLE_1)
            if found is None or found.timing is None or found.work is None or not found.errors:
                continue
            grid = found.errors["grid"]
            counts = (f"{100 * found.work.given_up:.1f} %", str(grid.missed), str(grid.false))
            relative = number(grid.mean_pixels / base) if base > 0.0 else "-"
            rows.append(
                (f"{row.name} `{name}`", relative, number(grid.mean_pixels), *counts, number(found.timing.median))
            )
    if rows:
        yield f"## Error against iterations (at most {TABLE_1}, as in table 1 of Bálint & Kiglics 2021)"
        yield (
            "Mean |t - t*| of the rays that hit in both, relative to `sphere` with as many steps, as theirs is; but "
            "against certified truth, and with the rays that are no part of that mean beside it: those given up, and "
            "those answered as misses or hits wrongly. Their truth was their own sphere tracer after a thousand steps."
        )
        head = ("scene, tracer", f"error / {REFERENCE}'s", "mean, pixels", "given up", "missed", "false", "ms")
        yield table(head, rows)


def keinert(results: Results) -> Iterator[str]:
    """Which omega is best, and what his ways to end a ray save."""
    rows = [row for row in results.places if len(_swept(row, 1.0)) > 2]
    if not rows:
        return
    yield "## Keinert's findings (2014), measured again"
    for row in rows:
        yield f"### {row.name}"
        yield _omega_table(row)
        yield "\n".join([*_best(row), *_early_exit(row)])
        forced = _forced(row)
        if forced:
            yield f"With at most {KEINERT_STEPS} steps, and half a pixel as the tolerance, as he has them:"
            yield forced
    yield _DIFFERENCES


def _swept(row: Row, tolerance: float) -> dict[float, Record]:
    found = {omega: row.at(name, tolerance) for name, omega in OMEGAS.items()}
    return {omega: r for omega, r in sorted(found.items()) if r is not None and r.work is not None}


def _evaluations(record: Record) -> float:
    return record.work.evaluations_mean if record.work is not None else float("nan")


def _time(record: Record) -> float:
    """In times of the reference's, drawn in turn."""
    return record.timing.median / record.timing.reference if record.timing is not None else float("nan")


def _omega_table(row: Row) -> str:
    fine, coarse = _swept(row, 1.0), _swept(row, HALF_PIXEL)
    rows = []
    for omega, record in fine.items():
        there = coarse.get(omega)
        rows.append(
            (
                f"{omega:.1f}",
                number(_evaluations(record)),
                number(_time(record)),
                "-" if there is None else number(_evaluations(there)),
                "-" if there is None else number(_time(there)),
                str(record.lost),
            )
        )
    sphere, rough = row.at(REFERENCE), row.at(REFERENCE, HALF_PIXEL)
    plain = [number(_evaluations(r)) if r is not None else "-" for r in (sphere, rough)]
    rows.insert(0, ("`sphere`", plain[0], "1", plain[1], "1", str(sphere.lost) if sphere is not None else "-"))
    head = ("omega", "evaluations", f"time / {REFERENCE}", "at half a pixel", f"time / {REFERENCE}", "lost")
    return table(head, rows)


def _best(row: Row) -> Iterator[str]:
    fine, sphere = _swept(row, 1.0), row.at(REFERENCE)
    fewest = min(fine, key=lambda omega: _evaluations(fine[omega]))
    fastest = min(fine, key=lambda omega: _time(fine[omega]))
    yield f"- The fewest evaluations are at omega {fewest:.1f}, the least time at {fastest:.1f}; he found 1.2 best."
    usual = fine.get(OMEGAS["relaxed"])
    if usual is not None and sphere is not None:
        saved = _evaluations(sphere) / _evaluations(usual)
        his = KEINERT.get(row.scene)
        beside = "" if his is None else f" (his times on such a scene: {his:.2f} times as fast)"
        yield (
            f"- At 1.2 plain sphere tracing takes {saved:.2f} times the evaluations, and "
            f"{1 / _time(usual):.2f} times the time{beside}."
        )


def _early_exit(row: Row) -> Iterator[str]:
    fine, coarse = row.at("relaxed"), row.at("relaxed", HALF_PIXEL)
    if fine is not None and coarse is not None and fine.work and coarse.work and coarse.errors:
        saved = 1.0 - _evaluations(coarse) / _evaluations(fine)
        grid = coarse.errors["grid"]
        yield (
            f"- To stop at half a pixel saves {100 * saved:.0f} % of the evaluations; it costs a p99 error of "
            f"{number(coarse.p99, 2)} pixels instead of {number(fine.p99, 2)}, and {grid.false} false hits of "
            f"{grid.rays} uncontested rays."
        )


_ENDS = {
    "sphere": "the last point is the hit",
    "relaxed:force=0": "a miss",
    "relaxed": "the nearest point, if within half a pixel",
    "relaxed:force=1e+09": "the nearest point (his forceHit)",
}


def _forced(row: Row) -> str:
    rows = []
    for name in FORCED:
        found = row.at(name, HALF_PIXEL, KEINERT_STEPS)
        if found is None or found.work is None or not found.errors:
            continue
        grid = found.errors["grid"]
        errors = (number(grid.mean_pixels), number(grid.pixels.p99))
        rows.append(
            (f"`{name}`", _ENDS[name], f"{100 * found.work.given_up:.1f} %", str(grid.missed), str(grid.false), *errors)
        )
    head = ("tracer", "at the limit", "given up", "missed", "false", "mean error, pixels", "p99")
    return table(head, rows) if rows else ""


_DIFFERENCES = """\
Where this differs from his paper, and why:

- His listing goes on with omega 1 for the rest of the ray once a look ahead has failed (ALGORITHMS A1, defect 3); ours
  takes one plain step and looks ahead again, so that a large omega is punished less.
- His listing loses hits that a failed look has passed (defect 1), which makes it faster than it may be: those rays end
  as misses. Ours may lose none; the column `lost` counts what it does lose.
- His times are a GPU's, with shading; ours are llvmpipe's, of depth alone. It runs eight pixels in lockstep and skips
  nothing, so that time follows the slowest pixel of eight, and the bookkeeping of relaxation is paid on every pass:
  what is saved in evaluations is not all saved in time.
- His error is not measured. Half a pixel is 64 times what sdfc asks for, and shows in the p99 error above.
- The scenes are of his kinds, not his: `jewel.sdf` after his figure 11, `city.sdf` from boxes."""
