"""The table of tracers: every module beside this one that has an ENTRY."""

from __future__ import annotations

import importlib
import pkgutil
from types import MappingProxyType

from sdfc.tracers.record import Choice, Tracer


def _table() -> MappingProxyType[str, Tracer]:
    rows: dict[str, Tracer] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(__path__) if m.name != "record"):
        entry = importlib.import_module(f"{__name__}.{module}").ENTRY
        assert isinstance(entry, Tracer) and entry.name == module, f"{module} must define the Tracer of its own name"
        rows[entry.name] = entry
    return MappingProxyType(rows)


TRACERS = _table()


def choice(spec: str) -> Choice:
    """The tracer of `NAME` or `NAME:PARAMETER=NUMBER:...`. ValueError, in words for the user, where there is none."""
    name, *settings = spec.split(":")
    if name not in TRACERS:
        raise ValueError(f"there is no tracer '{name}' (there are: {', '.join(TRACERS)})")
    tracer = TRACERS[name]
    values = {p.name: p.default for p in tracer.parameters}
    known = {p.name: p for p in tracer.parameters}
    for setting in settings:
        key, _, text = setting.partition("=")
        if key not in known:
            there = f"there are: {', '.join(known)}" if known else "it has none"
            raise ValueError(f"tracer '{name}' has no parameter '{key}' ({there})")
        try:
            values[key] = float(text)
        except ValueError:
            raise ValueError(f"'{text}' is no number (parameter '{key}' of tracer '{name}')") from None
        if known[key].is_whole and not values[key].is_integer():
            raise ValueError(f"parameter '{key}' of tracer '{name}' is a whole number, not {text}")
        if not known[key].low <= values[key] <= known[key].high:
            raise ValueError(
                f"parameter '{key}' of tracer '{name}' is from {known[key].low:g} to {known[key].high:g}, not {text}"
            )
    return Choice(tracer, values)
