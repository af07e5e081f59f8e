"""Law: `proven` keeps its guarantee wherever that is hard; and a tracer that does not keep its own is found out.

SDFC_FULL=1 draws every case at 48x27, in every way.
"""

from __future__ import annotations

import json
import os
import re
import shlex
from dataclasses import replace
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
from sdfc.glsl import assembly
from sdfc.measure.picture import Tracing
from sdfc.measure.stress import FAMILIES
from sdfc.measure.stress.record import Case, Family, look, scene
from sdfc.measure.stress.run import Outcome, chosen, stressed
from sdfc.measure.stress.trees import grown
from sdfc.measure.way import ways
from sdfc.tracers import TRACERS

PAGE = Path(__file__).parent.parent.parent / "docs" / "stress.md"
FULL = os.environ.get("SDFC_FULL") == "1"
SIZE = (48, 27) if FULL else (12, 8)
WAYS = ("proven", "proven+prepass", "proven+rays") if FULL else ("proven",)


@pytest.fixture(scope="session")
def tracing(renderer: GlRenderer) -> Tracing:
    return Tracing(renderer)


def stress(tracing: Tracing, families: tuple[Family, ...], *specs: str) -> list[Outcome]:
    return list(stressed(tracing, families, ways(specs), SIZE, lambda share: None))


@pytest.fixture
def saboteur(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> tuple[str, Saboteur]:
    """One of SABOTEURS, and its name in the table of tracers."""
    found: Saboteur = SABOTEURS[request.param]
    name = f"saboteur_{list(SABOTEURS).index(request.param)}"  # templates are cached by their names
    environment = assembly.environment()
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
    broken = {o.name: f"{o.way}: {o.trouble or o.failures}" for o in outcomes if o.is_broken}
    assert not broken, broken


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


def test_what_is_weak_is_a_family() -> None:
    for tracer in TRACERS.values():
        assert set(tracer.weak) <= {*FAMILIES, "random"}, tracer.name


def test_names_are_of_something() -> None:
    assert [f.name for f in chosen(())] == list(FAMILIES)
    (family,) = chosen(("nan/cone's*",))
    assert {case.name.partition(" ")[0] for case in family.cases} == {"cone's"}
    assert len(chosen(("nan/cone's apex", "start", "nan"))) == 2
    with pytest.raises(RequestError, match=r"no case 'twits'.*twist"):
        chosen(("twits",))
    with pytest.raises(RequestError, match="no case 'nan/nothing'"):
        chosen(("nan/nothing",))


def test_the_middle_ray_goes_where_the_camera_looks(tracing: Tracing) -> None:
    case = Case(name="", text=scene("sphere()"), view=look((0.0, 0.0, 3.0)), is_odd=True)
    assert case.pixels((12, 8)) == (13, 9)
    (outcome,) = stress(tracing, (Family(name="one", doc="", cases=(case,)),), "proven")
    assert outcome.trial is not None
    middle = outcome.trial.picture.d[:, 13 * 9 // 2]
    assert np.abs(middle[:2]).max() < 1e-7 and outcome.trial.picture.hit[13 * 9 // 2]


def test_the_same_seed_grows_the_same_scenes() -> None:
    first, again, other = grown(5, 3), grown(5, 3), grown(5, 4)
    assert first.cases == again.cases and first.cases != other.cases
    assert len({case.text for case in first.cases}) == 5


@pytest.mark.gpu
@pytest.mark.parametrize("saboteur", ["absolute"], indirect=True)
def test_a_run_by_the_command_line(
    opengl: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, saboteur: tuple[str, Saboteur]
) -> None:
    """A failure is told, drawn and counted; where the tracer says that it is weak it is no failure."""
    name, _ = saboteur
    arguments = ["stress", "scale/scaled by 0.01", "--tracers", f"proven,{name}", "--size", "12x8"]
    result = CliRunner().invoke(command, [*arguments, "-o", str(tmp_path / "out")], prog_name="sdfc")
    assert result.exit_code == 1, result.output
    assert "ok 1" in result.stdout and "FAILS 1 of 1" in result.stdout and "1 broke a guarantee" in result.stdout
    assert f"scale/scaled by 0.01 [{name}]" in result.stdout
    page, data = ((tmp_path / "out" / file).read_text() for file in ("stress.md", "stress.json"))
    told = json.loads(data)
    assert told["broken"] == 1 and [case["broken"] for case in told["cases"]] == [False, True]
    (picture,) = (tmp_path / "out").glob("*.png")
    assert picture.name in page and picture.read_bytes().startswith(b"\x89PNG")
    as_json = json.loads(CliRunner().invoke(command, [*arguments, "--json"], prog_name="sdfc").stdout)
    assert as_json["ok"] is False and as_json["cases"][1]["failures"] == told["cases"][1]["failures"]
    weak = replace(sdfc.tracers.TRACERS[name], weak={"scale": "it is said to be"})
    monkeypatch.setattr(sdfc.tracers, "TRACERS", {**sdfc.tracers.TRACERS, name: weak})
    excused = CliRunner().invoke(command, arguments, prog_name="sdfc")
    assert excused.exit_code == 0 and "weak 1 of 1" in excused.stdout and "no guarantee was broken" in excused.stdout


def test_what_cannot_be_is_said(tmp_path: Path) -> None:
    for arguments in (["nothing"], ["--tracers", "proven+x"], ["--size", "0x5"], ["--size", "12"], ["--random", "-1"]):
        result = CliRunner().invoke(command, ["stress", *arguments], prog_name="sdfc")
        assert result.exit_code == 2, f"{arguments}: {result.output}"
    (tmp_path / "file").write_text("")
    refused = CliRunner().invoke(command, ["stress", "scale", "-o", str(tmp_path / "file" / "x")], prog_name="sdfc")
    assert refused.exit_code == 2


def examples() -> list[str]:
    """The commands that docs/stress.md shows."""
    (block,) = re.findall(r"^```sh\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    return [line.partition("  #")[0].strip() for line in block.splitlines()]


@pytest.mark.gpu
@pytest.mark.parametrize("example", examples())
def test_the_examples_of_the_page(opengl: None, example: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(command, shlex.split(example)[1:], prog_name="sdfc")
    assert result.exit_code == 0, result.output
    assert "-o" not in example or (tmp_path / "stress-report" / "stress.md").exists()


def test_the_page_lists_every_family(request: pytest.FixtureRequest) -> None:
    """--update-golden writes the table anew."""
    rows = [f"| `{f.name}` | {len(f.cases)} | {f.doc} |" for f in FAMILIES.values()]
    table = "\n".join(["| family | cases | what is hard |", "| --- | --- | --- |", *rows]) + "\n"
    text = PAGE.read_text()
    made = re.sub(r"(<!-- families -->\n).*?(<!-- end -->)", lambda m: m[1] + table + m[2], text, flags=re.DOTALL)
    if request.config.getoption("--update-golden"):
        PAGE.write_text(made)
    assert made == PAGE.read_text()
