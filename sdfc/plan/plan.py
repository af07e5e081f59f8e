"""Everything that is decided before text is written."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sdfc.plan.cluster import CLUSTER, rows_at_once, turns
from sdfc.plan.steps import Any, Closed, Many, Step, is_closed, leaves_of
from sdfc.shape.material import Material
from sdfc.tracers.record import Choice, Tracer

# Units of the scene's own radius. A ray's intervals are right to about three roundings of numbers up to one.
GROW = 2.0**-22
CUT = 2.0**-20
SMALLEST_TOLERANCE = 2.0**-19  # sixteen roundings of numbers up to one
FINE = 1.0 / 64.0  # of half a pixel: what every tracer is asked for, so that times compare at equal error
LIFT = 2.0**-17  # how far shadow rays start above the surface: clear of CUT and of rounding
HORIZON = 1e5  # how far rays are marched in a scene without end
NEAR_EYE = 64.0  # radii: of the way from there one step of 11 bits leaves a thirtieth
TILE = 8  # pixels across a tile of the cone prepass (ALGORITHMS B7)
MOST_LOOPS = 60000  # llvmpipe stops all loops of an invocation together at 65 535 (GL.md 0)


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The step tree, the tracer, and what the shader needs besides."""

    root: Step
    choice: Choice
    materials: tuple[Material, ...]
    slopes: dict[int, float]  # the Lipschitz constant of each part's formula, by id of the part
    radius: float
    centre: tuple[float, float, float]
    is_finite: bool  # the whole scene lies in the unit ball of its own coordinates
    is_convex: bool = False  # the whole scene is one convex solid: nothing in it casts a shadow on it
    prepass: bool = False  # whether tiles of pixels are told first how far they are empty
    near_eye: bool = False  # whether the eye is within NEAR_EYE: rays are moved to the scene by one step, not two
    budget: int | None = None  # a measurer's limit on the passes of a ray's loops

    @property
    def tracer(self) -> Tracer:
        return self.choice.tracer

    @property
    def swept(self) -> Step:
        """What a cone prepass must find empty: all that the tracer marches."""
        if not self.tracer.needs_steps:
            return self.root
        steps = self.root.steps if isinstance(self.root, Any) else (self.root,)
        return Any(tuple(s for s in steps if not is_closed(s)))

    @property
    def can_sweep(self) -> bool:
        """Whether a prepass is legal, and not idle: something is marched, and all of it has a bound on its distance."""
        parts = [leaf.part for leaf in leaves_of(self.swept)]
        return bool(parts) and all(math.isfinite(self.slopes[id(part)]) for part in parts)

    @property
    def events(self) -> int:
        """How many ends of closed-form intervals there are outside tables: no loop of events runs longer than that.

        Solids have two of each interval: their own, and their core's (sdfc/plan/touch).
        """
        steps = self.root.steps if isinstance(self.root, Any) else (self.root,)
        single = [leaf for step in steps if not isinstance(step, Many) for leaf in leaves_of(step)]
        return sum(2 * leaf.intervals * (1 + leaf.inside) for leaf in single if isinstance(leaf, Closed))

    @property
    def rows_at_once(self) -> int:
        """How many rows a turn of the loops over tables takes."""
        return rows_at_once(self._rows)

    @property
    def table_turns(self) -> int:
        """How often the loops over tables may turn for one ray: once a cluster, once for so many rows."""
        return turns(self._rows, self.rows_at_once)

    @property
    def _rows(self) -> int:
        steps = self.root.steps if isinstance(self.root, Any) else (self.root,)
        tables = [len(step.members) for step in steps if isinstance(step, Many)]
        return sum(CLUSTER * (-(-n // CLUSTER)) for n in tables)
