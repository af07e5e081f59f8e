"""Fields that are a profile's, drawn out along z: along their walls a ray may go further than the distance to them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sdfc.field.graph import Expr
from sdfc.shape.definition import Environment
from sdfc.shape.graph import Apply


def drawn(shape: Apply) -> Expr | None:
    """How near to z = 0 the field's value is its profile's, but for where |z| less this is more; None: nowhere known.

    It is nowhere less than the profile's: what a ray meets, it meets no earlier than the profile without end.
    """
    known = _HALVES.get(shape.definition.name) if shape.definition.is_standard else None
    return None if known is None else known(shape.environment)


def _number(environment: Environment, name: str) -> Expr:
    value = environment[name]
    assert isinstance(value, Expr)
    return value


def _extruded(environment: Environment) -> Expr:
    return _number(environment, "height") / 2.0


def _rounded(environment: Environment) -> Expr:
    return _number(environment, "height") / 2.0 - _number(environment, "radius")


_HALVES: Mapping[str, Callable[[Environment], Expr]] = MappingProxyType(
    {"extrude": _extruded, "extrude_rounded": _rounded}
)
