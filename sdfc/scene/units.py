"""Units that may stand behind a number."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

from sdfc.diagnostics import SceneError, Span, scene_error
from sdfc.syntax import tree

# what a number of that unit is inside: angles are radians, lengths the scene's own unit
UNITS: Mapping[str, float] = MappingProxyType({"": 1.0, "deg": math.pi / 180, "rad": 1.0})


def unknown_unit(node: tree.Number) -> SceneError:
    """The error for a number with other letters behind it."""
    place = Span(node.span.source, node.span.end - len(node.unit), node.span.end)
    near = next((unit for unit in ("deg", "rad") if node.unit[0].lower() == unit[0]), None)
    hint = f"did you mean '{near}'?" if near else "the units are deg and rad; a length has none"
    return scene_error(f"unknown unit '{node.unit}'", place, hint)
