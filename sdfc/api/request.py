"""What a caller asks for, checked: sizes, live values, cameras, names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from sdfc.api.quantity import Quantity
    from sdfc.scene.model import Param

Setting: TypeAlias = "float | tuple[float, ...] | str | Quantity"
"""A live value: numbers as the scene has them inside (radians, linear colours), or as they are typed (`30deg`)."""

AUTO = "auto"  # the planner chooses the tracer
LARGEST_SIDE = 16384
MOST_PIXELS = 1 << 26  # a frame of float images takes 16 bytes a pixel, several times over
MOST_SAMPLES = 65536


class RequestError(ValueError):
    """What was asked for makes no sense, whatever the scene; exit code 2."""


@dataclass(frozen=True, slots=True)
class View:
    """Changes to the scene's camera; what is None stays. `fov` is the vertical angle in radians.

    `height` makes the camera orthographic: the height of what it sees, in the scene's units.
    """

    eye: tuple[float, float, float] | None = None
    target: tuple[float, float, float] | None = None
    up: tuple[float, float, float] | None = None
    fov: float | None = None
    height: float | None = None

    def __post_init__(self) -> None:
        for name, vector in (("eye", self.eye), ("target", self.target), ("up", self.up)):
            if vector is not None and (len(vector) != 3 or not all(map(math.isfinite, vector))):
                raise RequestError(f"the camera's {name} takes three finite numbers")
        if self.eye is not None and self.eye == self.target:
            raise RequestError("the camera's eye and target are the same point")
        if self.up is not None and not any(self.up):
            raise RequestError("the camera's up direction is zero")
        if self.fov is not None and not 0.0 < self.fov < math.pi:
            raise RequestError("the camera's fov must be between 0deg and 180deg")
        if self.height is not None and not 0.0 < self.height < math.inf:
            raise RequestError("the camera's height must be above zero")


def suggestion(name: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)`, or ` (there are a, b, c)`, for a message about a name that is not known."""
    from difflib import get_close_matches

    names = sorted(known)
    close = get_close_matches(name, names, n=1)
    if close:
        return f" (did you mean '{close[0]}'?)"
    return f" (there are: {', '.join(names)})" if names else " (there are none)"


def checked_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height, if a frame can have them."""
    width, height = size
    if width < 1 or height < 1:
        raise RequestError(f"a picture of {width}x{height} pixels has nothing in it")
    if max(width, height) > LARGEST_SIDE or width * height > MOST_PIXELS:
        raise RequestError(
            f"a picture of {width}x{height} pixels is too large"
            f" (at most {LARGEST_SIDE} across, and {MOST_PIXELS >> 20} million pixels)"
        )
    return width, height


def checked_samples(samples: int) -> int:
    """The number of samples a pixel, if it makes sense."""
    if not 1 <= samples <= MOST_SAMPLES:
        raise RequestError(f"samples must be between 1 and {MOST_SAMPLES}, not {samples}")
    return samples


def checked_names(kind: str, names: Iterable[str], known: tuple[str, ...]) -> tuple[str, ...]:
    """The names, in order and once each, if all are known."""
    wanted = tuple(dict.fromkeys(names))
    for name in wanted:
        if name not in known:
            raise RequestError(f"there is no {kind} '{name}'{suggestion(name, known)}")
    return wanted


def checked_tracer(spec: str) -> str:
    """A tracer's name, perhaps with values for its parameters (`relaxed:omega=1.4`), if there is one; or AUTO."""
    from sdfc.tracers import TRACERS, choice

    checked_names("tracer", (spec.partition(":")[0],), (AUTO, *TRACERS))
    if spec == AUTO:
        return spec
    try:
        return choice(spec).spec
    except ValueError as error:
        raise RequestError(str(error)) from None


def checked_params(params: tuple[Param, ...], given: Mapping[str, Setting]) -> dict[str, tuple[float, ...]]:
    """A value for every `param` of a scene: the given one, where it has the right size and lies in the range."""
    by_name = {param.name: param for param in params}
    for name in given:
        if name not in by_name:
            raise RequestError(f"the scene has no param '{name}'{suggestion(name, by_name)}")
    return {name: _checked_value(param, given.get(name, param.default)) for name, param in by_name.items()}


def _numbers(param: Param, value: Setting) -> tuple[float, ...]:
    from sdfc.api.quantity import Quantity, parse_quantity

    match value:
        case str():
            return parse_quantity(value).of(param.unit, param.name)
        case Quantity():
            return value.of(param.unit, param.name)
        case int() | float():
            return (float(value),)
        case _:
            return tuple(float(number) for number in value)


def _checked_value(param: Param, value: Setting) -> tuple[float, ...]:
    numbers = _numbers(param, value)
    if len(numbers) != param.type.size:
        takes = "a number" if param.type.size == 1 else f"{param.type.size} numbers"
        raise RequestError(f"param '{param.name}' takes {takes}, not {len(numbers)}")
    for number in numbers:
        if not math.isfinite(number):
            raise RequestError(f"param '{param.name}' takes finite numbers")
        if (param.low is not None and number < param.low) or (param.high is not None and number > param.high):
            shown = ", ".join(_shown(n, param.unit) for n in numbers)
            raise RequestError(f"param '{param.name}' = {shown} is outside its range, {_range(param)}")
    return numbers


def _range(param: Param) -> str:
    low = "" if param.low is None else _shown(param.low, param.unit)
    high = "" if param.high is None else _shown(param.high, param.unit)
    return f"{low}..{high}"


def _shown(number: float, unit: str) -> str:
    return f"{math.degrees(number):g}deg" if unit == "angle" else f"{number:g}"
