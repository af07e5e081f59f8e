"""What is typed after `--size`, `--set` and `--camera`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from sdfc.api.animation import Sweep
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

    return {name: parse_quantity(value) for name, value in _pairs(texts).items()}


def parse_changes(texts: Iterable[str]) -> dict[str, Quantity | Sweep]:
    """`name=value` and `name=start..end` pairs, each name once."""
    from sdfc.api.animation import parse_change

    return {name: parse_change(value) for name, value in _pairs(texts).items()}


def parse_frames(text: str) -> range:
    """`0..120`: the first frame and the last."""
    match = re.fullmatch(r"([+-]?\d{1,9})\s*\.\.\s*([+-]?\d{1,9})", text.strip())
    if match is None:
        raise click.BadParameter(f"'{text}' is not a first and a last frame like 0..120")
    first, last = int(match[1]), int(match[2])
    if last < first:
        raise click.BadParameter(f"'{text}' ends before it begins")
    return range(first, last + 1)


def _pairs(texts: Iterable[str]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            raise click.BadParameter(f"'{text}' is not of the form name=value")
        if name in pairs:
            raise click.BadParameter(f"'{name}' is set twice")
        pairs[name] = value
    return pairs


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
