"""Law: `proven` keeps its guarantee wherever it is hard to; and a tracer that does not is found out by who looks for it.

SDFC_FULL=1 draws every case at 48x27, in every way.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from jinja2 import ChoiceLoader, DictLoader
from saboteurs import SABOTEURS, Saboteur

import sdfc.tracers
from sdfc.api.renderer import GlRenderer
from sdfc.api.request import RequestError
from sdfc.cli.verbs import command
from sdfc.diagnostics import DeviceError
from sdfc.glsl import assembly
from sdfc.measure.picture import Tracing
from sdfc.measure.stress import FAMILIES
from sdfc.measure.stress.record import Case, Family, look, scene
from sdfc.measure.stress.run import Outcome, chosen, stressed
from sdfc.measure.stress.trees import grown
from sdfc.measure.stress.way import ways
from sdfc.tracers import TRACERS

FULL = os.environ.get("SDFC_FULL") == "1"
SIZE = (48, 27) if FULL else (12, 8)
WAYS = ("proven", "proven+prepass", "proven+rays") if FULL else ("proven",)


@pytest.fixture(scope="module")
def tracing() -> Iterator[Tracing]:
    """A renderer. Without OpenGL the test is skipped, unless SDFC_REQUIRE_GL=1 says that it must be there."""
    try:
        renderer = GlRenderer()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            raise
        pytest.skip(f"no OpenGL here: {error}")
    yield Tracing(renderer)
    renderer.close()


def stress(tracing: Tracing, families: tuple[Family, ...], *specs: str) -> list[Outcome]:
    return list(stressed(tracing, families, ways(specs), SIZE, lambda share: None))


@pytest.fixture
def saboteur(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> tuple[str, Saboteur]:
    """One of SABOTEURS, and its name in the table of tracers."""
    found: Saboteur = SABOTEURS[request.param]
    name = f"saboteur_{list(SABOTEURS).index(request.param)}"  # templates are cached by their names
    environment = assembly._environment()
    extra = DictLoader({f"trace/{name}.glsl": found.template})
    monkeypatch.setattr(environment, "loader", ChoiceLoader([extra, environment.loader]))
    monkeypatch.setattr(sdfc.tracers, "TRACERS", {**TRACERS, name: found.record(name)})
    return name, found


@pytest.mark.gpu
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_proven_keeps_its_guarantee(family: Family, tracing: Tracing) -> None:
    outcomes = stress(tracing, (family,), *WAYS)
    assert [o.trial is not None for o in outcomes] == [True] * len(family.cases) * len(WAYS), "it is legal everywhere"
    assert not TRACERS["proven"].weak
    broken = {f"{o.name} [{o.way}]": o.trouble or o.failures for o in outcomes if o.is_broken}
    assert not broken


@pytest.mark.gpu
@pytest.mark.parametrize("saboteur", SABOTEURS, indirect=True)
def test_who_breaks_a_guarantee_is_found_out(saboteur: tuple[str, Saboteur], tracing: Tracing) -> None:
    """Each of the patterns names cases of a family that is there for such a fault: at least one of them shows it."""
    name, wrong = saboteur
    unseen = []
    for pattern in wrong.caught_by:
        outcomes = stress(tracing, chosen((pattern,)), name)
        if not any(outcome.is_broken for outcome in outcomes):
            unseen.append(pattern)
    assert not unseen, f"{wrong.fault}: not seen by {unseen}"


def test_every_family_is_there_to_find_someone_out() -> None:
    """The faults above are of all kinds that the families are there for."""
    looked_at = {pattern.partition("/")[0] for saboteur in SABOTEURS.values() for pattern in saboteur.caught_by}
    assert looked_at >= set(FAMILIES) - {"blend", "equal", "deep"}  # which try the compiler, more than its tracers
