"""What a tracer says about itself, and how one is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that a published method leaves to its user; ours is the default. Legal in [low, high]."""

    name: str
    default: float
    low: float
    high: float
    doc: str
    is_whole: bool = False  # whether it must be a whole number


_ALONG = "a ray along a surface takes more passes than there are"
STALLS = dict.fromkeys(("tangent", "edge", "axis", "far", "flush", "random"), _ALONG) | {
    "distance": "from a million radii a ray that passes close by may be taken for a hit"
}
"""Where all are weak that step by the distance alone."""

FORCE = Parameter("force", 1.0, 0.0, 1e9, "given up, a ray hits where it came nearest, if so near: in half pixels")
REDUCE = Parameter(
    "reduce", 0.0, 0.0, 2.0, "hits are moved to where the field is the tolerance: 1 a Newton step, 2 three passes", True
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tracer:
    """A row of the table. Its template, `templates/trace/NAME.glsl`, defines `trace(o, d, start, limit)`.

    A template counts its work: `steps` one a pass of a loop, `evaluations` one a value of the whole scene; it sets
    `unfinished` to 1.0 where a ray was given up at MOST_STEPS. `parameter.NAME` in it is a GLSL literal.
    """

    name: str
    doc: str
    source: str  # author, year
    needs: str
    guarantee: str
    needs_map: bool  # whether it reads `float map(vec3 p)`
    needs_steps: bool  # whether it reads the generated `events` and `march`
    needs_span: bool = False  # whether it reads `vec4 map_span(vec3 p, vec3 d, float s)`
    parameters: tuple[Parameter, ...] = ()
    pace: float = 1.0  # its passes, of those that sphere tracing takes: a guide for predictions (ALGORITHMS E)
    weight: float = 1.0  # what a pass takes, in values of the scene
    weak: Mapping[str, str] = field(default_factory=dict)  # families of `sdfc stress` it may fail in, and why

    @property
    def template(self) -> str:
        return f"trace/{self.name}.glsl"


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """A tracer, with a value for each of its parameters."""

    tracer: Tracer
    values: Mapping[str, float]

    @property
    def spec(self) -> str:
        """How it is asked for: `relaxed`, or `relaxed:omega=1.4` where a value is not the default."""
        given = [(p.name, self.values[p.name]) for p in self.tracer.parameters if self.values[p.name] != p.default]
        return ":".join([self.tracer.name, *(f"{name}={value:g}" for name, value in given)])
