"""What a stress case is: a scene and a camera that are hard for numbers of 24 bits, and for whom it is known to be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from sdfc.api.request import View

Point = tuple[float, float, float]

_NOTHING: Mapping[str, tuple[float, ...]] = MappingProxyType({})


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A scene's text, its camera and the values of its params. Cases of one text share their shaders.

    `size` is (width, height) where the case needs one of its own: single lines of rays. `is_odd` asks for an odd size,
    so that the ray in the middle goes exactly where the camera looks.
    """

    name: str
    text: str
    view: View
    params: Mapping[str, tuple[float, ...]] = field(default_factory=lambda: _NOTHING)
    size: tuple[int, int] | None = None
    is_odd: bool = False

    def pixels(self, size: tuple[int, int]) -> tuple[int, int]:
        """How large it is drawn in a run of pictures of `size`."""
        width, height = self.size or size
        return (width | 1, height | 1) if self.is_odd else (width, height)


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Cases that are hard for the same reason. `name` is one word: what users ask for, and a tracer's `weak` says."""

    name: str
    doc: str
    cases: tuple[Case, ...]


ORIGIN: Point = (0.0, 0.0, 0.0)
UP: Point = (0.0, 1.0, 0.0)


def look(eye: Point, target: Point = ORIGIN, fov: float = 0.6) -> View:
    """A camera with perspective; `fov` in radians from bottom to top."""
    return View(eye=eye, target=target, up=UP, fov=fov)


def parallel(eye: Point, target: Point = ORIGIN, height: float = 2.4) -> View:
    """A camera without perspective that sees `height` from bottom to top."""
    return View(eye=eye, target=target, up=UP, height=height)


def needle(point: Point, way: Point) -> View:
    """A camera whose every ray starts at `point` less `way` and goes along `way`, to the last bit: it has no height.

    The middle ray of any other camera is an ulp beside: where a ray starts is interpolated.
    """
    return parallel((point[0] - way[0], point[1] - way[1], point[2] - way[2]), point, 1e-60)


def scene(*solids: str, before: str = "") -> str:
    """The text of a scene of these solids."""
    return f"{before}\nscene {{ {' '.join(solids)} }}\n"
