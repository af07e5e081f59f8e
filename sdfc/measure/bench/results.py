"""Records, looked up as reports need them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from sdfc.api.request import AUTO
from sdfc.measure.bench.plan import FLOOR, FOREIGN, OWN
from sdfc.measure.bench.record import Cell, Record
from sdfc.measure.bench.store import Store, ordered

PUBLISHED = ("relaxed", "enhanced", "auto_relaxed", "segment")
SLACK = 1.02  # errors this close are equal


@dataclass(frozen=True, slots=True)
class Row:
    """A scene at a size."""

    name: str
    scene: str
    size: str
    records: dict[Cell, Record]

    def at(self, tracer: str, tolerance: float = 1.0, budget: int | None = None) -> Record | None:
        """The tracer's record, if it has one with a time."""
        found = self.records.get(Cell(self.scene, tracer, self.size, tolerance, budget))
        return found if found is not None and found.timing is not None else None

    def all_of(self, tracer: str) -> list[Record]:
        """The tracer's records without a budget."""
        return [r for c, r in self.records.items() if c.tracer == tracer and c.budget is None and r.timing is not None]

    def best(self, tracers: Iterable[str]) -> Record | None:
        """The fastest of these at tolerance 1; of those that lose the fewest rays."""
        found = [r for name in tracers if (r := self.at(name)) is not None and r.errors]
        fewest = min((r.lost for r in found), default=0)
        return min((r for r in found if r.lost == fewest), key=_ms, default=None)

    @property
    def illegal(self) -> dict[str, str]:
        """Why, by tracer."""
        return {c.tracer: r.illegal for c, r in self.records.items() if r.illegal is not None}


class Results:
    """A run. `rows` are the scenes on which all tracers were compared; `places` are they and those of the sweeps."""

    def __init__(self, store: Store) -> None:
        records = ordered(store.records.values())
        places = dict.fromkeys((r.cell.scene, r.cell.size) for r in records)
        self.places = [
            Row(
                f"{scene} {size}",
                scene,
                size,
                {r.cell: r for r in records if (r.cell.scene, r.cell.size) == (scene, size)},
            )
            for scene, size in places
        ]
        rows = [row for row in self.places if row.at(FLOOR) is not None]
        one_size = len({row.size for row in rows}) == 1
        self.rows = [replace(row, name=row.scene) for row in rows] if one_size else rows
        names = dict.fromkeys(r.cell.tracer for r in records)
        self.tracers = tuple(n for n in names if ":" not in n and n != FLOOR and not n.startswith(FOREIGN))
        self.ours = AUTO if AUTO in self.tracers else OWN


def speed_up(row: Row, other: Record | None, ours: str) -> float:
    """How many times as fast ours is, with no larger p99 error and no more wrong rays; NaN where it is not so.

    Ours is at the other's tolerance, its frames drawn in turn with the other's, or else at the fastest that is so.
    """
    if other is None or not other.errors:
        return math.nan
    allowed = other.p99 * SLACK if other.p99 == other.p99 else math.inf
    good = [r for r in row.all_of(ours) if r.errors and not r.p99 > allowed and r.wrong <= other.wrong]
    beside = [r for r in good if r.cell.tolerance == other.cell.tolerance]
    return max((_ms(other) / _ms(r) for r in beside or good), default=math.nan)


def _ms(record: Record) -> float:
    assert record.timing is not None
    return record.timing.median
