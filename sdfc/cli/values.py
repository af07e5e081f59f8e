"""What is typed after `--size`, `--set` and `--camera`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from sdfc.api.quantity import Quantity

_VECTORS = ("eye", "target", "up")
_NUMBERS = {"fov": "angle", "height": "length"}


def parse_size(text: str) -> tuple[int, int]:
    """`640x360`: width and height."""
    match = re.fullmatch(r"(\d{1,9})[xX,](\d{1,9})", text.strip())
    if match is None:
        raise click.BadParameter(f"'{text}' is not a size like 1280x720")
    return int(match[1]), int(match[2])


def parse_settings(texts: Iterable[str]) -> dict[str, Quantity]:
    """`name=value` pairs, each name once."""
    from sdfc.api.quantity import parse_quantity

    settings: dict[str, Quantity] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            raise click.BadParameter(f"'{text}' is not of the form name=value")
        if name in settings:
            raise click.BadParameter(f"'{name}' is set twice")
        settings[name] = parse_quantity(value)
    return settings


def parse_camera(texts: Iterable[str]) -> dict[str, Any]:
    """`eye=1,2,3 target=0,0,0 fov=35deg`: any of the camera's values, in one text or several."""
    given = parse_settings(part for text in texts for part in _camera_parts(text))
    return {name: _camera_value(name, quantity) for name, quantity in given.items()}


def _camera_parts(text: str) -> list[str]:
    """Split at blanks and semicolons, but not at those around commas and equal signs or inside brackets."""
    joined = re.sub(r"\s*([,=])\s*", r"\1", re.sub(r"\[\s+|\s+\]", lambda match: match[0].strip(), text))
    return [part for part in re.split(r"[;\s]+", joined) if part]


def _camera_value(name: str, quantity: Quantity) -> tuple[float, ...] | float:
    from sdfc.cli.failure import suggestion

    if name in _VECTORS:
        if len(quantity.numbers) != 3:
            raise click.BadParameter(f"the camera's {name} takes three numbers, as in {name}=1,2,3")
        return quantity.of("length", name)
    if name in _NUMBERS:
        if len(quantity.numbers) != 1:
            raise click.BadParameter(f"the camera's {name} takes one number")
        return quantity.of(_NUMBERS[name], name)[0]
    known = (*_VECTORS, *_NUMBERS)
    close = suggestion(name, known) or f" (it has {', '.join(known)})"
    raise click.BadParameter(f"a camera has no '{name}'{close}")
