"""The table of tracers: every module beside this one that has an ENTRY."""

from __future__ import annotations

import importlib
import pkgutil
from types import MappingProxyType

from sdfc.tracers.record import Tracer


def _table() -> MappingProxyType[str, Tracer]:
    rows: dict[str, Tracer] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(__path__) if m.name != "record"):
        entry = importlib.import_module(f"{__name__}.{module}").ENTRY
        assert isinstance(entry, Tracer) and entry.name == module, f"{module} must define the Tracer of its own name"
        rows[entry.name] = entry
    return MappingProxyType(rows)


TRACERS = _table()
