"""A scene, elaborated: what there is to see, from where, in what light."""

from __future__ import annotations

from dataclasses import dataclass, field

from sdfc.diagnostics import Diagnostic, Source, Span
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.shape.graph import Shape, ShapeGraph


@dataclass(frozen=True, slots=True)
class Param:
    """A live value: a uniform of the shader. `unit` is 'number', 'angle' or 'color' (for controls and `--set`)."""

    name: str
    type: Type
    default: tuple[float, ...]
    low: float | None
    high: float | None
    unit: str
    span: Span


@dataclass(frozen=True, slots=True)
class Camera:
    """Where the picture is taken from. `fov` is the vertical angle (radians); a `height` makes it orthographic."""

    eye: Expr
    target: Expr
    up: Expr
    fov: Expr
    height: Expr | None = None


@dataclass(frozen=True, slots=True)
class Sun:
    """Light from far away. `direction` is the way that the light travels."""

    direction: Expr
    color: Expr
    intensity: Expr


@dataclass(frozen=True, slots=True)
class PointLight:
    """Light from a point; its intensity is that at distance one, and falls with the square of the distance."""

    position: Expr
    color: Expr
    intensity: Expr


Light = Sun | PointLight


@dataclass(frozen=True, slots=True)
class Sky:
    """The light from all around: a vertical gradient (the up direction is +y in scenes, the camera's up elsewhere)."""

    zenith: Expr
    horizon: Expr
    ground: Expr


@dataclass(frozen=True, slots=True)
class Scene:
    """What every way in (the scene language, OpenSCAD's .csg) makes, and all that the compiler reads."""

    source: Source
    values: FieldGraph
    shapes: ShapeGraph
    root: Shape
    params: tuple[Param, ...] = ()
    camera: Camera | None = None  # None: framed from the bounds
    lights: tuple[Light, ...] = ()
    sky: Sky | None = None
    warnings: tuple[Diagnostic, ...] = ()
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)  # used where no camera says: +z for .csg
    files: tuple[str, ...] = field(default=())  # every file that was read, for watchers
