"""The bounds that standard primitives claim, in plain numbers: most parts of most scenes are such, and constant."""

from __future__ import annotations

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.program import Numbers, Program
from sdfc.shape.graph import Apply
from sdfc.shape.lower import generic

# By name: no more than there are, and the same in every scene. None where values are part of the formula itself.
_PROGRAMS: dict[str, Program | None] = {}


def claimed_corners(shape: Apply, level: float, values: FieldGraph) -> tuple[Numbers, Numbers] | None:
    """The corners of a standard primitive's box, as its claim has them; None where they must be asked for."""
    definition = shape.definition
    if not definition.is_standard or not definition.is_primitive:
        return None
    if definition.name not in _PROGRAMS:
        _PROGRAMS[definition.name] = _program(shape, values)
    program = _PROGRAMS[definition.name]
    if program is None:
        return None
    leaves: list[Numbers] = []
    for argument in shape.arguments:
        if not isinstance(argument, Expr) or not argument.is_constant:
            return None
        leaves.append(argument.numbers)
    low, high = program([*leaves, (level,)])
    return low, high


def _program(shape: Apply, values: FieldGraph) -> Program | None:
    asked, level = generic(shape, values), values.input("level", Type.FLOAT)
    bounds = shape.definition.claims.bounds
    if asked is shape or bounds is None:
        return None
    leaves = [argument for argument in asked.arguments if isinstance(argument, Expr)]
    return Program([*leaves, level], bounds(asked.environment, {}, level))
