"""The table of what is hard: every family of every module in `cases`."""

from __future__ import annotations

import importlib
import pkgutil
from types import MappingProxyType

from sdfc.measure.stress import cases
from sdfc.measure.stress.record import Case, Family

__all__ = ["FAMILIES", "Case", "Family"]


def _table() -> MappingProxyType[str, Family]:
    rows: dict[str, Family] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(cases.__path__)):
        for family in importlib.import_module(f"{cases.__name__}.{module}").FAMILIES:
            assert isinstance(family, Family) and family.name not in rows, f"two families {family.name}"
            rows[family.name] = family
    return MappingProxyType(rows)


FAMILIES = _table()
