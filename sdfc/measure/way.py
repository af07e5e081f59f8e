"""A way to trace that is asked for in words: a tracer or the planner's choice, and what goes with it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from sdfc.api.request import AUTO, RequestError, checked_names, checked_tracer
from sdfc.pipeline import Options

_EXTRAS = MappingProxyType[str, dict[str, Any]]({"prepass": {"prepass": True}, "rays": {"rays": "all"}})
_EXTRA = re.compile(r"\+(?=[a-z])")  # not that of 1e+09


@dataclass(frozen=True, slots=True)
class Way:
    """`TRACER[:PARAMETER=NUMBER...][+prepass][+rays]`: with the cone prepass, with every closed form there is.

    Or `auto`, whose options are None: the planner's choice depends on the scene.
    """

    name: str
    options: Options | None


def way(spec: str) -> Way:
    """The way of that name. Raises RequestError where there is none."""
    named, *given = _EXTRA.split(spec)
    wanted = checked_names("addition to a tracer", given, tuple(_EXTRAS))
    tracer = checked_tracer(named)
    if tracer == AUTO:
        if wanted:
            raise RequestError(f"'{AUTO}' chooses what goes with its tracer: without '+{wanted[0]}', please")
        return Way(AUTO, None)
    options = Options(tracer=tracer)
    extras = [extra for extra in _EXTRAS if extra in wanted]
    for extra in extras:
        options = replace(options, **_EXTRAS[extra])
    return Way("+".join([tracer, *extras]), options)


def ways(specs: Iterable[str]) -> tuple[Way, ...]:
    """Each way once, in order."""
    return tuple({found.name: found for found in map(way, specs)}.values())
