"""The light of a scene that names none: a warm sun over the viewer's left shoulder, and a soft sky. Plain numbers."""

import math
from dataclasses import dataclass
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class SkyNumbers:
    """Linear radiance of the sky overhead, at the horizon, and of the ground below."""

    zenith: Vector
    horizon: Vector
    ground: Vector


@dataclass(frozen=True, slots=True)
class SunNumbers:
    """`direction` is the way the light travels; its irradiance is `color` (linear) times `intensity`."""

    direction: Vector
    color: Vector
    intensity: float


SKY = SkyNumbers(zenith=(0.21, 0.32, 0.52), horizon=(0.86, 0.88, 0.91), ground=(0.23, 0.225, 0.22))
SUN_COLOR: Vector = (1.0, 0.89, 0.74)
SUN_INTENSITY = 4.4
SUN_HEIGHT = math.radians(42.0)
"""The sun's elevation."""
SUN_LEFT = math.radians(48.0)
"""How far left of the viewer's back the sun stands, seen from above."""


def key_sun(eye: Vector, target: Vector, up: Vector) -> SunNumbers:
    """The default sun for a camera: from its upper left, at a fixed height above the horizon that `up` defines."""
    upward = _unit(up)
    back = _unit(tuple(e - t for e, t in zip(eye, target, strict=True)))
    along = sum(b * u for b, u in zip(back, upward, strict=True))
    level = tuple(b - along * u for b, u in zip(back, upward, strict=True))
    if math.hypot(*level) < 1e-6:
        level = _any_perpendicular(upward)
    behind = _unit(level)
    left = _cross(behind, upward)
    ahead, aside = math.cos(SUN_LEFT), math.sin(SUN_LEFT)
    flat, rise = math.cos(SUN_HEIGHT), math.sin(SUN_HEIGHT)
    x, y, z = (-flat * (ahead * b + aside * a) - rise * u for b, a, u in zip(behind, left, upward, strict=True))
    return SunNumbers((x, y, z), SUN_COLOR, SUN_INTENSITY)


def _unit(v: tuple[float, ...]) -> Vector:
    size = math.hypot(*v) or 1.0
    return v[0] / size, v[1] / size, v[2] / size


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _any_perpendicular(v: Vector) -> Vector:
    return _cross(v, (1.0, 0.0, 0.0) if abs(v[0]) < 0.9 else (0.0, 0.0, 1.0))
