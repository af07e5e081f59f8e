"""The listings as they are printed, or published as code: one ray at a time, in float32. Right only where they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Point: TypeAlias = NDArray[np.float32]
Field: TypeAlias = Callable[[Point], float]
Along: TypeAlias = Callable[[float], float]

F = np.float32
INFINITY = float("inf")


@dataclass(slots=True)
class Told:
    """What a listing returned, and where it looked."""

    t: float = INFINITY
    looks: list[float] = field(default_factory=list)

    @property
    def hit(self) -> bool:
        return bool(self.t < INFINITY)


@np.errstate(all="ignore")
def keinert(
    f: Field,
    o: Point,
    d: Point,
    *,
    t_min: float = 0.0,
    t_max: float = 1e9,
    pixel_radius: float = 1e-3,
    force_hit: bool = False,
    most: int = 128,
    omega: float = 1.2,
) -> Told:
    """Keinert et al. 2014, listing 2."""
    told = Told()
    relax, t = F(omega), F(t_min)
    candidate_error, candidate_t = F(INFINITY), F(t_min)
    previous_radius = step_length = F(0.0)
    function_sign = F(-1.0 if f(o) < 0.0 else 1.0)
    for _ in range(most):
        told.looks.append(float(t))
        signed_radius = function_sign * F(f(d * t + o))
        radius = abs(signed_radius)
        failed = relax > 1.0 and radius + previous_radius < step_length
        if failed:
            step_length -= relax * step_length
            relax = F(1.0)
        else:
            step_length = signed_radius * relax
        previous_radius = radius
        error = radius / t
        if not failed and error < candidate_error:
            candidate_t, candidate_error = t, error
        if (not failed and error < pixel_radius) or t > t_max:
            break
        t += step_length
    if (t > t_max or candidate_error > pixel_radius) and not force_hit:
        return told
    told.t = float(candidate_t)
    return told


@np.errstate(all="ignore")
def enhanced(f: Along, t_max: float, *, omega: float = 1.0, most: int = 128) -> Told:
    """The step of Balint and Valasek 2018 at omega 1, and its test as it is stated: do the balls meet?"""
    told = Told()
    t = r = z = F(0.0)
    for _ in range(most):
        at = F(t + z)
        told.looks.append(float(at))
        v = F(f(float(at)))
        if z > r + abs(v):
            z = r
            continue
        slope = F(-1.0) if z == 0.0 else F((v - r) / z)
        t, r = at, v
        if r < 1e-5 or t > t_max:
            break
        z = F(r + F(omega) * r * (F(1.0) + slope) / max(F(1.0) - slope, F(1e-6)))
    if r < 1e-5 and t <= t_max:
        told.t = float(t)
    return told


@np.errstate(all="ignore")
def galin(
    f: Along, steepest: Callable[[float, float], float], a: float, b: float, *, epsilon: float, growth: float = 1.5
) -> Told:
    """Galin et al. 2020, as their own code has it, for a field that is positive outside.

    `steepest(t, u)`: a bound of the slope's size over [t, u].
    """
    told = Told()
    t, tentative = F(a), F(b - a)
    while t < b and len(told.looks) < 100_000:
        told.looks.append(float(t))
        value = F(f(float(t)))
        if value < 0.0:
            told.t = float(t)
            break
        step = min(abs(value) / F(steepest(float(t), float(t + tentative))), tentative)
        t += max(step, F(epsilon))
        tentative = step * F(growth)
    return told


@np.errstate(all="ignore")
def liktor(
    f: Along,
    box_end: float,
    *,
    delta: float,
    sphere_steps: int = 32,
    falsi_steps: int = 4,
    looks_again: bool = True,
    start: float = 0.0,
) -> Told:
    """Liktor 2008, listing 2. `looks_again`: f1 is computed anew after the overshoot, which the listing forgets."""
    told = Told()
    pos1 = F(start)
    for _ in range(sphere_steps):
        told.looks.append(float(pos1))
        pos1 += F(f(float(pos1)))
    inside = bool(pos1 <= box_end)
    f1 = F(f(float(pos1)))
    if f1 >= 0.0:
        pos1 += F(delta)
        f1 = F(f(float(pos1))) if looks_again else f1
    if not (inside and f1 < 0.0):
        return told
    pos2 = F(pos1 - 4.0 * delta)
    f2 = F(f(float(pos2)))
    spos = (pos1 * f2 - pos2 * f1) / (f2 - f1)
    for _ in range(falsi_steps):
        told.looks.append(float(spos))
        t = F(f(float(spos)))
        if t > 0.0:
            f2, pos2 = t, spos
        else:
            f1, pos1 = t, spos
        spos = (pos1 * f2 - pos2 * f1) / (f2 - f1)
    told.t = float(spos)
    return told
