"""What a stress run found: a table for the terminal, Markdown and plain values for files."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

from sdfc.measure.stress.record import Family
from sdfc.measure.stress.run import Outcome
from sdfc.reference.compare import Spread

_MOST_TOLD = 12  # failures that the terminal is told of, one by one


def told(outcomes: Sequence[Outcome], families: Sequence[Family], ways: Sequence[str]) -> str:
    """For a terminal: a row a family, a column a way; then what broke."""
    rows = [["", *ways], *([f.name, *(_cell(_of(outcomes, f.name, way)) for way in ways)] for f in families)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    broken = [o for o in outcomes if o.is_broken]
    lines += ["", *(f"{o.name} [{o.way}]: {_words(o).splitlines()[0]}" for o in broken[:_MOST_TOLD])] if broken else []
    lines += [f"and {len(broken) - _MOST_TOLD} more"] if len(broken) > _MOST_TOLD else []
    return "\n".join([*lines, "", summary(outcomes)])


def summary(outcomes: Sequence[Outcome]) -> str:
    """One line."""
    traced = [o for o in outcomes if o.trial is not None]
    rays = sum(o.trial.picture.hit.size for o in traced if o.trial is not None)
    contested = sum(int((~o.trial.sure).sum()) for o in traced if o.trial is not None)
    broken, weak = sum(o.is_broken for o in outcomes), sum(bool(o.failures and o.weak) for o in outcomes)
    share = f" ({contested / rays:.1%} of them contested)" if rays else ""
    excused = f"; {weak} failed where the tracer says that it may" if weak else ""
    verdict = f"{broken} broke a guarantee" if broken else "no guarantee was broken"
    return f"{len(traced)} pictures of {rays} rays{share}: {verdict}{excused}"


def markdown(
    outcomes: Sequence[Outcome], families: Sequence[Family], ways: Sequence[str], pictures: dict[int, str], device: str
) -> str:
    """The report as a page. `pictures`: file names by the index of the outcome."""
    lines = ["# `sdfc stress`", "", f"{summary(outcomes)}. Drawn by {device}.", ""]
    lines += ["| family | cases | " + " | ".join(ways) + " |", "| --- | --- |" + " --- |" * len(ways)]
    for family in families:
        cells = [_cell(_of(outcomes, family.name, way)) for way in ways]
        lines.append(f"| {family.name}: {family.doc} | {len(family.cases)} | " + " | ".join(cells) + " |")
    failed = [(i, o) for i, o in enumerate(outcomes) if o.failures or o.trouble]
    for index, outcome in failed:
        kind = "" if outcome.is_broken else " (said to be weak here)"
        lines += ["", f"## {outcome.name} by {outcome.way}{kind}", "", _words(outcome)]
        if index in pictures:
            lines += ["", f"![{outcome.name}](<{pictures[index]}>)"]
        lines += ["", "```sdf", outcome.case.text.strip()[:2000], "```", "", f"`{outcome.case.view}`"]
    return "\n".join(lines) + "\n"


def plain(outcomes: Sequence[Outcome], size: tuple[int, int], device: str) -> dict[str, Any]:
    """For JSON: numbers that do not exist are None."""
    broken = sum(o.is_broken for o in outcomes)
    return {
        "device": device,
        "size": list(size),
        "broken": broken,
        "weak": sum(bool(o.failures and o.weak) for o in outcomes),
        "cases": [_plain(o) for o in outcomes],
    }


def _plain(outcome: Outcome) -> dict[str, Any]:
    told = {"family": outcome.family, "case": outcome.case.name, "tracer": outcome.way}
    reasons = {"weak": outcome.weak, "illegal": outcome.illegal, "trouble": outcome.trouble}
    told |= {name: reason for name, reason in reasons.items() if reason}
    if outcome.trial is None:
        return {**told, "broken": outcome.is_broken}
    trial = outcome.trial
    return {
        **told,
        "broken": outcome.is_broken,
        "failures": outcome.failures,
        "rays": int(trial.picture.hit.size),
        "hits": int(trial.picture.hit.sum()),
        "contested": int((~trial.sure).sum()),
        "error_pixels": _spread(outcome.error),
        "error": _spread(Spread.of(trial.error)),
        "most_steps": float(trial.picture.steps.max()),
    }


def _spread(spread: Spread) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in (spread.median, spread.p99, spread.maximum)]


def _of(outcomes: Sequence[Outcome], family: str, way: str) -> list[Outcome]:
    return [o for o in outcomes if o.family == family and o.way == way]


def _cell(outcomes: Sequence[Outcome]) -> str:
    """A family and a way in a few words."""
    legal = [o for o in outcomes if not o.illegal]
    failed = [o for o in legal if o.failures or o.trouble]
    if not legal:
        return "not legal"
    if not failed:
        return f"ok {len(legal)}"
    kinds: Counter[str] = sum((Counter(o.failures) for o in failed), Counter())
    what = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common(3)) or "the truth"
    word = "FAILS" if any(o.is_broken for o in failed) else "weak"
    return f"{word} {len(failed)} of {len(legal)}: {what}"


def _words(outcome: Outcome) -> str:
    if outcome.trouble or outcome.trial is None:
        return outcome.trouble
    trial = outcome.trial
    rays = ", ".join(f"{count} {kind}" for kind, count in outcome.failures.items())
    where = int(trial.wrong.argmax())
    o, d = (", ".join(f"{v:.9g}" for v in vector[:, where]) for vector in (trial.picture.o, trial.picture.d))
    answer = f"{trial.picture.depth[where]:.9g}" if trial.picture.hit[where] else "a miss"
    truth = f"{trial.truth.t_lo[where]:.9g}" if trial.truth.status[where] == 1 else "a miss"
    return (
        f"{rays} of {trial.picture.hit.size} rays ({int((~trial.sure).sum())} contested); "
        f"the first from {o} along {d} (in the scene's own unit and origin): {answer}, and truly {truth}"
    )
