"""A way to trace that is asked for in words: a tracer, and what goes with it."""

from __future__ import annotations

from dataclasses import dataclass

from sdfc.api.request import RequestError, checked_tracer, suggestion
from sdfc.pipeline import Options
from sdfc.tracers import TRACERS, choice
from sdfc.tracers.record import Tracer

_EXTRAS = ("prepass", "rays")


@dataclass(frozen=True, slots=True)
class Way:
    """`TRACER[:PARAMETER=NUMBER...][+prepass][+rays]`: with the cone prepass, with every closed form there is."""

    name: str
    tracer: Tracer
    options: Options


def way(spec: str) -> Way:
    """The way of that name. Raises RequestError where there is none."""
    named, *extras = spec.split("+")
    for extra in extras:
        if extra not in _EXTRAS:
            raise RequestError(f"nothing goes with a tracer as '+{extra}'{suggestion(extra, _EXTRAS)}")
    tracer = checked_tracer(named)
    chosen = [extra for extra in _EXTRAS if extra in extras]
    options = Options(tracer=tracer, prepass="prepass" in chosen, rays="all" if "rays" in chosen else "cheap")
    return Way("+".join([tracer, *chosen]), choice(tracer).tracer, options)


def ways(specs: tuple[str, ...]) -> tuple[Way, ...]:
    """Each way once, in order; without any, every tracer of the table."""
    return tuple({found.name: found for found in map(way, specs or tuple(TRACERS))}.values())
