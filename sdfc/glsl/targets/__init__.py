"""The table of targets: every module beside this one that has an ENTRY."""

from __future__ import annotations

import importlib
import pkgutil
from types import MappingProxyType

from sdfc.glsl.targets.record import Target


def _table() -> MappingProxyType[str, Target]:
    rows: dict[str, Target] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(__path__)):
        entry = getattr(importlib.import_module(f"{__name__}.{module}"), "ENTRY", None)
        if entry is not None:  # what several targets share has none
            assert isinstance(entry, Target) and entry.name == module, f"{module} must be the Target of its own name"
            rows[entry.name] = entry
    return MappingProxyType(rows)


TARGETS = _table()
