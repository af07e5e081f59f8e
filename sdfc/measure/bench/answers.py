"""Rays in the float32 numbers that tracers have, and what a depth image answers about them."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc.api.request import View
from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram
from sdfc.pipeline import Compiled

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Index: TypeAlias = NDArray[np.intp]
Size: TypeAlias = tuple[int, int]

RAYS = (files("sdfc.templates") / "bench" / "rays.frag").read_text()
SEED = 20261122  # of the random pixels: the same in every run, so that truth is proved once


@dataclass(frozen=True, slots=True)
class Rays:
    """o + t d in the scene's own coordinates, both (3, n): float32 numbers as float64."""

    o: Array
    d: Array


@dataclass(frozen=True, slots=True)
class Answers:
    """Of n rays: `depth` in the scene's own unit, NaN for a miss; `given_up`: answered at the most steps."""

    hit: Mask
    depth: Array
    steps: Array
    evaluations: Array
    given_up: Mask

    @classmethod
    def of(cls, image: NDArray[Any], radius: float) -> Answers:
        """From what the entry `depth` draws, (height, width, 4)."""
        depth, steps, evaluations, sure = np.moveaxis(image.reshape(-1, 4).astype(np.float64), -1, 0)
        hit = sure > 0.5
        return cls(hit, np.where(hit, depth / radius, np.nan), steps, evaluations, (sure > 0.0) & (sure < 1.0))

    def some(self, index: Index) -> Answers:
        """Some of the rays."""
        return Answers(*(getattr(self, name)[index] for name in self.__slots__))


class RayDrawing:
    """Draws rays on a device."""

    def __init__(self, device: Device, vertex: str) -> None:
        self._program = FragmentProgram(device, RAYS, vertex)
        self._device = device

    def rays(self, compiled: Compiled, size: Size) -> Rays:
        """Every pixel's, rows from the top."""
        with Frame(self._device, *size, 2) as frame:
            frame.draw_whole(self._program, compiled.uniforms(View(), {}, size))
            o, d = (np.moveaxis(frame.read(i)[..., :3], -1, 0).reshape(3, -1).astype(np.float64) for i in (0, 1))
        return Rays(np.ascontiguousarray(o), np.ascontiguousarray(d))


def random_pixels(size: Size, count: int) -> Index:
    """So many pixels of a picture (or all that it has), in order, none twice."""
    total = size[0] * size[1]
    chosen = np.random.default_rng(SEED).choice(total, min(count, total), replace=False)
    return np.sort(chosen).astype(np.intp)


def covered(image: NDArray[Any]) -> Answers | None:
    """From a colour image whose alpha says what was hit; None where it says the same of every pixel, so nothing."""
    hit = image.reshape(-1, 4)[:, 3] > 0.5
    nothing = np.zeros(hit.size)
    if hit.all() or not hit.any():
        return None
    return Answers(hit, nothing, nothing, nothing, np.zeros(hit.size, bool))
