"""What a target says about itself, and what it is told of a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from sdfc.glsl.source import Item

Part: TypeAlias = Literal["field", "tracer", "full"]
PARTS: tuple[Part, ...] = ("field", "tracer", "full")
Numbers: TypeAlias = tuple[float, ...]
Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Control:
    """A `param` of the scene as the program that draws it sees it: `uniform` is its name there."""

    param: str
    uniform: str
    type: str  # of GLSL
    unit: str  # number, angle (in radians) or color (linear)
    default: Numbers
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Eye:
    """The camera at the params' values of now, in the scene's units. `half`: tan(fov / 2), or half the height."""

    eye: Vector
    target: Vector
    up: Vector
    half: float
    is_parallel: bool


@dataclass(frozen=True, slots=True)
class Brief:
    """All that a program needs to know to bind what was emitted."""

    title: str
    part: Part
    stage: str
    prefix: str
    controls: Sequence[Control]  # the params that the text reads
    materials: Sequence[str]
    guarantee: str  # of the tracer
    tracer: str
    radius: float
    centre: Vector
    low: Vector  # the box of the finite parts
    high: Vector
    is_finite: bool  # whether the box holds the whole scene
    has_box: bool  # else there are no finite parts
    up: Vector
    eye: Eye
    is_baked: bool  # whether the params are constants of the text
    uniforms: Mapping[str, Numbers]  # the camera's and the params', at 1280 x 720
    other: Callable[[str, str], str]  # the same order for another target and stage


def as_is(items: list[Item], _: Brief) -> list[Item]:
    """No lowering."""
    return items


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A row of the table. Its templates are `templates/target/...`, or an entry's own."""

    name: str
    doc: str
    use: str  # how what is emitted is bound, in a sentence for the header
    full: Mapping[str, str]  # the template of each stage of a complete shader
    suffix: Mapping[str, str]  # of files, by stage
    version: str = ""  # what stands behind #version in a complete shader
    precision: bool = False  # whether floats and ints must be declared to be precise
    refused: Mapping[Part, str] = field(default_factory=dict)  # what it does not give, and why
    camera: str = "lib/camera_uniform.glsl"  # gives `camera_ray` to complete shaders
    pixel: Mapping[str, str] = field(default_factory=dict)  # where the pixel's centre is, by stage
    start: str = ""  # where rays of complete shaders begin, if not at the eye
    full_part: Part = "full"  # what its complete shader is made around
    is_baked: bool = False  # whether it has no uniforms of one's own
    is_prefixed: bool = False  # whether the names of a complete shader need a prefix too
    is_description: bool = False  # whether it tells of all other targets
    is_told: bool = False  # whether such a description holds its texts
    hands_state: bool = False  # whether functions that remember take a `State` first
    is_pair: bool = False  # whether its stages belong together
    lower: Callable[[list[Item], Brief], list[Item]] = as_is  # the items of a shader become the dialect's
    page: Mapping[Part, str] = field(default_factory=dict)  # the template of the file around the text

    @property
    def stages(self) -> tuple[str, ...]:
        return tuple(self.full)
