"""What a run measures: which tracers, tolerances and budgets on which scene, in groups that are timed in turn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path

from sdfc.api.request import AUTO, RequestError
from sdfc.measure.bench.answers import Size
from sdfc.measure.bench.record import Cell
from sdfc.tracers import TRACERS

FLOOR = "floor"  # rays that are made, and not traced
FOREIGN = "foreign"  # `foreign:FILE` is somebody's own shader
OWN = "proven"  # sdfc's own tracer
REFERENCE = "sphere"  # what ratios are to
TOLERANCES = (1.0, 8.0, 64.0)  # times what sdfc asks for; 64: half a pixel
BUDGETS = (8, 16, 32, 64, 128, 256)  # Balint & Kiglics 2021, figure 6
BUDGETED = ("jewel.sdf", "city.sdf", "blobs.sdf")  # the scenes of error against budget, where none are named
SWEPT = ("jewel.sdf", "city.sdf")  # Keinert's kinds of scene
HALF_PIXEL = 64.0  # the tolerance at which Keinert's rays end: a radius of half a pixel
OMEGAS = {"relaxed" if i == 2 else f"relaxed:omega={1.0 + 0.1 * i:g}": 1.0 + 0.1 * i for i in range(10)}
"""The omega of each tracer that is compared with others of its kind; the default is 1.2, Keinert's choice."""
FORCED = ("sphere", "relaxed:force=0", "relaxed", "relaxed:force=1e+09")
KEINERT_STEPS = 80  # his limit
AFFORDABLE = 6e6  # nodes of the field times rays: half a minute's truth, on a CPU of 2024
QUICK = ("csg5.sdf", "jewel.sdf", "blobs.sdf", "lamp.sdf")
QUICK_BUDGETS = (16, 64)


@dataclass(frozen=True, slots=True)
class Sweep:
    """Parameters of a tracer, compared at one tolerance and budget."""

    names: tuple[str, ...]
    tolerance: float = 1.0
    budget: int | None = None


KEINERT = (
    Sweep((REFERENCE, *OMEGAS)),
    Sweep((REFERENCE, *OMEGAS), HALF_PIXEL),
    Sweep(FORCED, HALF_PIXEL, KEINERT_STEPS),
)
"""His findings: which omega is best, what his early exit saves, what the choice of a candidate saves."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A run. `budgets` are measured on the scenes `budgeted` (by file name) at tolerance 1, `sweeps` on `swept`, both
    in pictures that are `aside` times smaller: what counts there is a ray's steps.

    `grid`: the small picture whose every ray is judged; `random`: how many rays of the timed picture are. `most`: so
    many nodes of the field times rays are affordable for the truth of each; where there are more, of some of the rays.
    `foreign`: shaders of others, for a run of one scene.
    """

    scenes: tuple[Path, ...]
    tracers: tuple[str, ...]
    sizes: tuple[Size, ...] = ((640, 360),)
    tolerances: tuple[float, ...] = TOLERANCES
    budgets: tuple[int, ...] = ()
    budgeted: tuple[str, ...] = ()
    sweeps: tuple[Sweep, ...] = ()
    swept: tuple[str, ...] = ()
    aside: int = 1
    repeat: int = 7
    grid: Size = (160, 90)
    random: int = 2000
    most: float = AFFORDABLE
    foreign: tuple[Path, ...] = ()

    def sizes_of(self, scene: str) -> tuple[Size, ...]:
        """At which a scene is measured."""
        more = map(self._aside, self.sizes) if scene in (*self.swept, *self.budgeted) else ()
        return tuple(dict.fromkeys((*self.sizes, *more)))

    def _aside(self, size: Size) -> Size:
        """The size of what is measured of parameters and budgets."""
        return max(1, size[0] // self.aside), max(1, size[1] // self.aside)

    def groups(self, scene: str, size: Size) -> list[Group]:
        """What is measured of a scene at a size. A group's tracers are timed in turn, the reference among them."""
        made = []
        if size in self.sizes:
            names = (*self.tracers, *(f"{FOREIGN}:{p.name}" for p in self.foreign))
            made = [Group(scene, size, (*names, FLOOR), self.tolerances[0], None)]
            made += [Group(scene, size, names, tolerance, None) for tolerance in self.tolerances[1:]]
        if size in map(self._aside, self.sizes):
            if scene in self.swept:
                made += [Group(scene, size, s.names, s.tolerance, s.budget) for s in self.sweeps]
            if scene in self.budgeted:
                few = tuple(name for name in self.tracers if name != AUTO)
                made += [Group(scene, size, few, 1.0, budget) for budget in self.budgets]
        return made

    def has_choice(self, scene: str) -> bool:
        """Whether the planner's choice is among what is measured."""
        return any(AUTO in g.names for size in self.sizes_of(scene) for g in self.groups(scene, size))

    @property
    def cells(self) -> int:
        """How many cells there are in all."""
        places = ((path.name, size) for path in self.scenes for size in self.sizes_of(path.name))
        return sum(len(group.names) for scene, size in places for group in self.groups(scene, size))

    @property
    def settings(self) -> dict[str, str]:
        """For the file of results."""
        grid, random = f"{self.grid[0]}x{self.grid[1]}", f"{self.random} random pixels of the timed size"
        fewer = "" if self.most == inf else f"; fewer of them where rays times nodes of the field exceed {self.most:g}"
        return {"truth": f"every ray at {grid}, and {random}{fewer}", "rounds": f"at most {self.repeat}"}


@dataclass(frozen=True, slots=True)
class Group:
    """Cells that are timed together."""

    scene: str
    size: Size
    names: tuple[str, ...]
    tolerance: float
    budget: int | None

    @property
    def reference(self) -> str:
        """What all of the group are timed beside."""
        return REFERENCE if REFERENCE in TRACERS else self.names[0]

    def cell(self, name: str) -> Cell:
        """The cell of one of the names."""
        return Cell(self.scene, name, f"{self.size[0]}x{self.size[1]}", self.tolerance, self.budget)

    def cells(self) -> Iterator[Cell]:
        """All of them."""
        return (self.cell(name) for name in self.names)


def all_tracers() -> tuple[str, ...]:
    """Every tracer, by its usual parameters; the reference first, the planner's choice last."""
    return (*sorted(TRACERS, key=lambda name: (name != REFERENCE, name)), AUTO)


def full() -> Wanted:
    """The run of the repository's results, as it is without scenes."""
    return Wanted((), all_tracers(), budgets=BUDGETS, budgeted=BUDGETED, sweeps=KEINERT, swept=SWEPT, aside=2)


def quick() -> Wanted:
    """A minute's."""
    return Wanted(
        (),
        all_tracers(),
        sizes=((320, 180),),
        tolerances=(1.0,),
        budgets=QUICK_BUDGETS,
        budgeted=BUDGETED[:1],
        repeat=3,
        grid=(80, 45),
        random=500,
    )


def usual_scenes(only: tuple[str, ...] = ()) -> tuple[Path, ...]:
    """The scenes of the folder `scenes` here, or of the checkout that sdfc runs from; those of these names.

    Raises RequestError where there is neither.
    """
    for folder in (Path("scenes"), Path(__file__).parents[3] / "scenes"):
        found = sorted(p for p in folder.glob("*") if p.suffix in (".sdf", ".csg") and (not only or p.name in only))
        if found:
            return tuple(found)
    raise RequestError("there is no folder 'scenes' here, nor does sdfc run from a checkout: name the scenes")
