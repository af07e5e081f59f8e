"""What is kept of a measurement: one record a cell, with numbers that survive JSON."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, TypeAlias

Json: TypeAlias = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Cell:
    """What is measured: a scene's file name, a tracer (`relaxed:omega=1.4`) or a foreign shader (`foreign:FILE`), ...

    `size`: WxH, as drawn and timed. `tolerance`: times what sdfc asks for. `budget`: at most so many passes of a ray's
    loop (None: as many as the compiler allows).
    """

    scene: str
    tracer: str
    size: str
    tolerance: float = 1.0
    budget: int | None = None

    def __str__(self) -> str:
        budget = "" if self.budget is None else f", at most {self.budget} steps"
        return f"{self.scene}, {self.tracer}, {self.size}, tolerance {self.tolerance:g}{budget}"

    @property
    def order(self) -> tuple[str, str, float, int, str]:
        """How cells are sorted."""
        return self.scene, self.size, self.tolerance, self.budget or 0, self.tracer


@dataclass(frozen=True, slots=True)
class Timing:
    """Milliseconds a frame: median and quartiles of `rounds` frames, drawn in turn with those of the other tracers.

    `reference`: the median of the reference tracer's frames in the same rounds, so that ratios are of like with like.
    """

    median: float
    low: float
    high: float
    rounds: int
    reference: float

    @property
    def gain(self) -> float:
        """How many times as fast as the reference."""
        return self.reference / self.median


@dataclass(frozen=True, slots=True)
class Building:
    """Milliseconds from scene to picture: proving, printing, the driver's GLSL front end, and machine code.

    `first_draw` is how much longer the first frame (a tiny one) took than the second: llvmpipe compiles then. `length`:
    characters.
    """

    compile: float
    emit: float
    front_end: float
    first_draw: float
    length: int


@dataclass(frozen=True, slots=True)
class Work:
    """Per pixel of the timed frame. `given_up`: the share of rays that were answered at the most steps."""

    steps_mean: float
    steps_p99: float
    steps_max: float
    evaluations_mean: float
    evaluations_p99: float
    given_up: float


@dataclass(frozen=True, slots=True)
class Spread:
    """Of errors; NaN where there are none."""

    median: float = math.nan
    p99: float = math.nan
    maximum: float = math.nan


@dataclass(frozen=True, slots=True)
class Errors:
    """A tracer's answers against certified truth; all but `contested...` and `ambiguous` are of uncontested rays.

    `pixels`, `ulps`: |t - t*| of rays that hit in both, in footprints of a pixel and in float32 ulps of the largest
    coordinate; `mean_pixels` is the mean. `residual`: |f| at the hit, in radii of the scene. `normals`: degrees, off
    creases. `stalls`: rays given up that truth decides.
    """

    rays: int
    hits: int
    missed: int
    false: int
    early: int = 0
    late: int = 0
    not_finite: int = 0
    stalls: int = 0
    contested: int = 0
    contested_wrong: int = 0
    ambiguous: int = 0
    mean_pixels: float = math.nan
    pixels: Spread = Spread()
    ulps: Spread = Spread()
    residual: Spread = Spread()
    normals: Spread = Spread()

    @property
    def wrong(self) -> int:
        """Uncontested rays that missed, hit nothing, or were answered before or behind where they may be."""
        return self.missed + self.false + self.early + self.late + self.not_finite


@dataclass(frozen=True, slots=True)
class Record:
    """A cell's result. `key` is of all that it depends on: where it changes, the cell is measured anew. `note`: of what
    was measured (what the planner chose).

    `illegal`: why this tracer may not trace this scene; there is nothing else then. `errors`: by the set of rays,
    `grid` (every pixel of a small picture) and `random` (pixels of the timed one).
    """

    cell: Cell
    key: str
    when: str
    commit: str
    note: str = ""
    illegal: str | None = None
    timing: Timing | None = None
    building: Building | None = None
    work: Work | None = None
    errors: dict[str, Errors] = dataclasses.field(default_factory=dict)

    @property
    def wrong(self) -> int:
        """Of all sets of rays."""
        return sum(e.wrong for e in self.errors.values())

    @property
    def lost(self) -> int:
        """Wrong rays that are not merely early: that is an error of depth, and p99 tells it."""
        return self.wrong - sum(e.early for e in self.errors.values())

    @property
    def p99(self) -> float:
        """Of |t - t*| in pixels, on the grid; NaN where nothing was judged."""
        grid = self.errors.get("grid")
        return math.nan if grid is None else grid.pixels.p99

    def to_json(self) -> Json:
        """Plain values, to six digits; what is not finite is null, which JSON has."""
        made: Json = _plain(dataclasses.asdict(self))
        return made

    @classmethod
    def from_json(cls, given: Json) -> Record:
        """The inverse of `to_json`."""
        errors = {name: _errors(values) for name, values in given["errors"].items()}
        parts: Json = {
            name: None if given[name] is None else kind(**_numbers(given[name]))
            for name, kind in (("timing", Timing), ("building", Building), ("work", Work))
        }
        kept = {name: given[name] for name in ("key", "when", "commit", "note", "illegal")}
        return cls(cell=Cell(**given["cell"]), errors=errors, **kept, **parts)


_SPREADS = ("pixels", "ulps", "residual", "normals")


def _errors(given: Json) -> Errors:
    spreads: Json = {name: Spread(**_numbers(given[name])) for name in _SPREADS}
    return Errors(**_numbers({n: v for n, v in given.items() if n not in _SPREADS}), **spreads)


def _numbers(given: Json) -> Json:
    return {name: math.nan if value is None else value for name, value in given.items()}


def _plain(value: Any) -> Any:
    match value:
        case dict():
            return {name: _plain(v) for name, v in value.items()}
        case float():
            return float(f"{value:.6g}") if math.isfinite(value) else None
        case _:
            return value
