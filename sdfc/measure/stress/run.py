"""All that was asked for, scene by scene: which guarantee was broken, by whom, how badly."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

from sdfc import pipeline
from sdfc.api.choose import decide, options_of
from sdfc.api.renderer import GlRenderer
from sdfc.api.request import RequestError, suggestion
from sdfc.diagnostics import InternalError, SceneError, Source
from sdfc.measure.picture import Tracing
from sdfc.measure.stress import FAMILIES
from sdfc.measure.stress.record import Case, Family
from sdfc.measure.stress.trial import Trial, tried
from sdfc.measure.way import Way
from sdfc.pipeline import Compiled
from sdfc.reference.compare import Spread
from sdfc.scene.model import Scene

Size = tuple[int, int]
Progress = Callable[[float], None]


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What became of one case in one way. Rays are counted; errors are of uncontested hits, in half pixels.

    `failures`: rays by how they break the guarantee. `weak`: why the tracer does not give it here. `illegal`: why it
    may not trace the scene at all. `trouble`: the two proofs of the truth disagree, or the compiler failed: a bug.
    """

    family: str
    case: Case
    way: str
    trial: Trial | None
    weak: str = ""
    illegal: str = ""
    trouble: str = ""

    @property
    def name(self) -> str:
        return f"{self.family}/{self.case.name}"

    @property
    def failures(self) -> dict[str, int]:
        return self.trial.failures if self.trial is not None else {}

    @property
    def is_broken(self) -> bool:
        """Whether a guarantee that is given was not kept."""
        return bool(self.trouble) or bool(self.failures and not self.weak)

    @property
    def error(self) -> Spread:
        """In half pixels."""
        return Spread.of(self.trial.error_pixels) if self.trial is not None else Spread(*[float("nan")] * 3)


def chosen(patterns: Iterable[str], families: Iterable[Family] = FAMILIES.values()) -> tuple[Family, ...]:
    """The families, each with the cases that one of the patterns names: `FAMILY`, or `FAMILY/CASE` with `*` and `?`.

    Without patterns, all. Raises RequestError where a pattern names nothing.
    """
    wanted, known = tuple(patterns), tuple(families)
    for pattern in wanted:
        if not any(_is_named(family, case, pattern) for family in known for case in family.cases):
            raise RequestError(f"there is no case '{pattern}'{suggestion(pattern, [family.name for family in known])}")
    found = []
    for family in known:
        cases = tuple(c for c in family.cases if not wanted or any(_is_named(family, c, p) for p in wanted))
        found += [Family(name=family.name, doc=family.doc, cases=cases)] if cases else []
    return tuple(found)


def _is_named(family: Family, case: Case, pattern: str) -> bool:
    return pattern == family.name or fnmatchcase(f"{family.name}/{case.name}", pattern)


def stressed(
    tracing: Tracing, families: Iterable[Family], ways: tuple[Way, ...], size: Size, progress: Progress
) -> Iterator[Outcome]:
    """Every case in every way, in order. `progress` is told the share done, after each scene."""
    scenes: dict[tuple[str, str], list[Case]] = {}
    for family in families:
        for case in family.cases:
            scenes.setdefault((family.name, case.text), []).append(case)
    for done, ((family_name, _), cases) in enumerate(scenes.items()):
        for way in ways:
            progress((done + ways.index(way) / len(ways)) / len(scenes))
            yield from _outcomes(tracing, family_name, cases, way, size)
    progress(1.0)


def _outcomes(tracing: Tracing, family: str, cases: list[Case], way: Way, size: Size) -> Iterator[Outcome]:
    try:
        compiled = _compiled(_scene(cases[0]), way, tracing.renderer)
        if isinstance(compiled, str):
            yield from (Outcome(family, case, way.name, None, illegal=compiled) for case in cases)
            return
        trials = tried(tracing, compiled, cases, size)
    except InternalError as error:
        yield from (Outcome(family, case, way.name, None, trouble=str(error)) for case in cases)
        return
    weak = compiled.plan.tracer.weak.get(family, "")
    yield from (Outcome(family, case, way.name, trial, weak) for case, trial in zip(cases, trials, strict=True))


def _scene(case: Case) -> Scene:
    return pipeline.load(Source(f"{case.name}.sdf", case.text), None)


def _compiled(scene: Scene, way: Way, renderer: GlRenderer) -> Compiled | str:
    """Compiled, or why the tracer may not trace this."""
    try:
        options = way.options or options_of(decide(scene, renderer, pilot=False).chosen)
        return pipeline.compile_scene(scene, options)
    except SceneError as error:
        return "; ".join(d.message for d in error.diagnostics)
