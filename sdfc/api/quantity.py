"""Values as people type them: `0.5`, `30deg`, `1,2,3`, `#ff8800`."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from sdfc.api.request import RequestError

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_SINGLE = re.compile(rf"(?P<number>{_NUMBER})(?P<unit>deg|rad)?")
_COLOR = re.compile(r"#(?:[0-9a-fA-F]{3}|[0-9a-fA-F]{6})")
_ANGLES = {"deg": math.pi / 180.0, "rad": 1.0}
_CONSTANTS = {"pi": math.pi, "tau": math.tau, "true": 1.0, "false": 0.0}


@dataclass(frozen=True, slots=True)
class Quantity:
    """One or more numbers: angles in radians, colours linear. `unit` is None where none was written."""

    numbers: tuple[float, ...]
    unit: str | None = None

    def of(self, unit: str, name: str) -> tuple[float, ...]:
        """The numbers, if the unit that was written goes with the one that `name` has: a bare number is no angle."""
        if unit == "angle" and self.unit != "angle":
            bare = f"{self.numbers[0]:g}"
            raise RequestError(f"'{name}' is an angle: write {bare}deg or {bare}rad")
        if unit != "angle" and self.unit == "angle":
            raise RequestError(f"'{name}' is not an angle")
        return self.numbers


def parse_quantity(text: str) -> Quantity:
    """`0.5`, `30deg`, `0.5rad`, `1,2,3` or `[1, 2, 3]`, `#f80` or `#ff8800` (sRGB)."""
    stripped = text.strip()
    if _COLOR.fullmatch(stripped):
        return Quantity(_linear(stripped[1:]), "color")
    if stripped.startswith("[") and stripped.endswith("]"):
        stripped = stripped[1:-1]
    parts = [_single(part.strip(), text) for part in stripped.split(",")]
    units = {unit for _, unit in parts}
    if len(units) > 1:
        raise RequestError(f"'{text}' mixes angles and numbers")
    return Quantity(tuple(number for number, _ in parts), units.pop())


def _single(text: str, whole: str) -> tuple[float, str | None]:
    if text in _CONSTANTS:
        return _CONSTANTS[text], None
    match = _SINGLE.fullmatch(text)
    if match is None:
        raise RequestError(f"'{whole}' is not a value like 0.5, 30deg, 1,2,3 or #ff8800")
    number, unit = float(match["number"]), match["unit"]
    return (number, None) if unit is None else (number * _ANGLES[unit], "angle")


def _linear(digits: str) -> tuple[float, ...]:
    """sRGB hexadecimal digits to linear components (IEC 61966-2-1)."""
    doubled = "".join(digit * 2 for digit in digits) if len(digits) == 3 else digits
    encoded = [int(doubled[index : index + 2], 16) / 255.0 for index in (0, 2, 4)]
    return tuple(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in encoded)
