"""What a page may ask for: a picture drawn here. Everything else is refused."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

from sdfc.api.request import RequestError, View

SMALLEST_SIDE, LARGEST_SIDE = 16, 1920  # pixels of a picture
_MOST_BRACKETS = 64  # opened in a message: a camera and sixteen params have far fewer
_LARGEST_NUMBER = 2**53  # that a request may have: as JavaScript counts
_LARGEST_FLOAT = 3.4e38  # that a shader has; differences of such are finite here
_KEYS = frozenset({"type", "request", "camera", "params", "size"})
_CAMERA = frozenset({"eye", "target", "up", "fov", "height"})


class WishError(Exception):
    """A message that no page of ours sends."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera, complete, in the scene's units and radians; a height makes it orthographic."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float]
    fov: float | None
    height: float | None

    def view(self) -> View:
        """Raises RequestError for what is no camera."""
        if (self.fov is None) == (self.height is None):
            raise RequestError("a camera has either a fov or a height: the other one is null")
        return View(self.eye, self.target, self.up, self.fov, self.height)


@dataclass(frozen=True, slots=True)
class Wish:
    """`draw`: a picture from there, with these params. Not yet held against the scene."""

    request: int
    camera: Camera
    params: Mapping[str, tuple[float, ...]]
    size: tuple[int, int]


def wish_of(message: str | bytes) -> Wish:
    """The message, understood. Raises WishError."""
    if not isinstance(message, str):
        raise WishError("no binary frames")
    if message.count("[") + message.count("{") > _MOST_BRACKETS:  # too deep a nest could overflow a thread's stack
        raise WishError("too many lists")
    try:
        given = json.loads(message, parse_constant=_no_number)
    except ValueError:
        raise WishError("not JSON") from None
    fields = _object(given, _KEYS)
    if fields["type"] != "draw":
        raise WishError("unknown type")
    width, height = _listed(fields["size"], 2)
    return Wish(
        _whole(fields["request"], 0, _LARGEST_NUMBER),
        _camera(fields["camera"]),
        _params(fields["params"]),
        (_whole(width, SMALLEST_SIDE, LARGEST_SIDE), _whole(height, SMALLEST_SIDE, LARGEST_SIDE)),
    )


def _camera(given: object) -> Camera:
    fields = _object(given, _CAMERA)
    fov, height = (None if fields[name] is None else _number(fields[name]) for name in ("fov", "height"))
    return Camera(_vector(fields["eye"]), _vector(fields["target"]), _vector(fields["up"]), fov, height)


def _params(given: object) -> dict[str, tuple[float, ...]]:
    if not isinstance(given, dict):
        raise WishError("params")
    return {name: tuple(_number(number) for number in _listed(value, None)) for name, value in given.items()}


def _object(given: object, keys: frozenset[str]) -> dict[str, Any]:
    if not isinstance(given, dict) or given.keys() != keys:
        raise WishError("unknown fields")
    return given


def _vector(given: object) -> tuple[float, float, float]:
    x, y, z = (_number(number) for number in _listed(given, 3))
    return x, y, z


def _listed(given: object, size: int | None) -> list[Any]:
    if not isinstance(given, list) or (size is not None and len(given) != size):
        raise WishError("not such a list")
    return given


def _number(given: object) -> float:
    try:
        number = float(given) if isinstance(given, int | float) and not isinstance(given, bool) else math.nan
    except OverflowError:
        number = math.inf
    if not abs(number) <= _LARGEST_FLOAT:
        raise WishError("not a number that a shader has")
    return number


def _whole(given: object, low: int, high: int) -> int:
    if not isinstance(given, int) or isinstance(given, bool) or not low <= given <= high:
        raise WishError("not such a number")
    return given


def _no_number(word: str) -> NoReturn:
    raise ValueError(word)
