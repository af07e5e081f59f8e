"""The verb `sdfc bench`: what it writes, what it exits with."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sdfc.cli.verbs import command
from sdfc.measure.bench import contest
from sdfc.measure.bench.record import Cell
from sdfc.measure.bench.store import read

BALL = "camera { eye: [0, 0, 5], target: [0, 0, 0], fov: 30deg } scene { sphere(radius: 1) }"
SMALL = ("--sizes", "48x27", "--grid", "32x18", "--random", "50", "--repeat", "2", "--tracers", "sphere,proven")
CELL = Cell("ball.sdf", "proven", "48x27")

Bench = Callable[..., Result]


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """`bench("ball.sdf", ...)`, in an empty folder that has that scene."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.sdf").write_text(BALL)
    return lambda *arguments: CliRunner().invoke(command, ["bench", *arguments], prog_name="sdfc")


@pytest.mark.gpu
def test_without_a_folder_it_prints_and_writes_nothing(bench: Bench, opengl: None, tmp_path: Path) -> None:
    result = bench("ball.sdf", *SMALL, "--tolerances", "1")
    assert (result.exit_code, result.stderr) == (0, "")
    rows = [line.split("|")[1].strip() for line in result.stdout.splitlines() if line.startswith("| ")]
    assert rows[0] == "tracer" and sorted(rows[2:]) == ["floor", "proven", "sphere"]
    assert [p.name for p in tmp_path.iterdir()] == ["ball.sdf"]


@pytest.mark.gpu
def test_a_folder_of_results_and_what_is_made_of_it(bench: Bench, opengl: None, tmp_path: Path) -> None:
    result = bench("ball.sdf", *SMALL, "--budgets", "4,8", "-o", "one")
    assert result.exit_code == 0
    assert (tmp_path / "one" / "results.md").read_text() == result.stdout
    drawn = {p.name for p in (tmp_path / "one").glob("*.png")}
    plots = {"ball.steps.png", "time-error.png", "ratios.png", "budgets.png"}
    assert drawn == (plots if importlib.util.find_spec("matplotlib") else set())
    store = read(tmp_path / "one")
    assert {c.budget for c in store.records} == {None, 4, 8}
    assert "renderer" in store.machine and store.settings["rounds"] == "at most 2"
    assert bench("--report", "one", "-o", "page.md").exit_code == 0
    page = (tmp_path / "page.md").read_text()
    assert "sdfc bench --report one -o" in page and "| ball.sdf " in page
    assert bench("--report", "one").stdout == page.replace("-o page.md", "-o -")

    assert bench("--compare", "one", "one").exit_code == 0
    (tmp_path / "two").mkdir()
    record = store.records[CELL]
    worse = {**record.errors, "grid": replace(record.errors["grid"], false=3)}
    store.records[CELL] = replace(record, errors=worse)
    (tmp_path / "two" / "results.json").write_text(store.text())
    compared = bench("--compare", "one", "two")
    assert compared.exit_code == 1 and f"worse: {CELL}: 0 -> 3 wrong" in compared.stdout


@pytest.mark.gpu
def test_without_matplotlib_it_says_so_and_goes_on(
    bench: Bench, opengl: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    result = bench("ball.sdf", *SMALL, "--tolerances", "1", "-o", "one")
    assert result.exit_code == 0
    assert result.stderr.count("note: no plots: matplotlib is not installed") == 1
    assert sorted(p.name for p in (tmp_path / "one").iterdir()) == ["results.json", "results.md"]


@pytest.mark.gpu
def test_interrupted_it_keeps_what_there_is(
    bench: Bench, opengl: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frame_times, calls = contest.frame_times, []

    def interrupted(*arguments: object) -> object:
        calls.append(arguments)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return frame_times(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(contest, "frame_times", interrupted)
    result = bench("ball.sdf", *SMALL, "-o", "kept")
    assert result.exit_code == 130
    kept = read(tmp_path / "kept").records
    assert {c.tolerance for c in kept} == {1.0} and len(kept) == 3
    assert bench("ball.sdf", *SMALL, "-o", "kept").exit_code == 0
    whole = read(tmp_path / "kept").records
    assert len(whole) == 7 and all(whole[c].when == r.when for c, r in kept.items())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("ball.sdf", "--tracers", "sphre"), "there is no tracer 'sphre' (did you mean 'sphere'?)"),
        (("ball.sdf", "--tracers", "sphere+prepas"), "no addition to a tracer 'prepas' (did you mean 'prepass'?)"),
        (("ball.sdf", "--tracers", ","), "there is nothing in the list"),
        (("ball.sdf", "--sizes", "big"), "'big' is not a size like 1280x720"),
        (("ball.sdf", "--sizes", "0x3"), "a picture of 0x3 pixels has nothing in it"),
        (("ball.sdf", "--grid", "0x3"), "a picture of 0x3 pixels has nothing in it"),
        (("ball.sdf", "--tolerances", "0"), "'0' is not above zero"),
        (("ball.sdf", "--budgets", "8,x"), "'x' is not a number of steps"),
        (("absent.sdf",), "'absent.sdf' does not exist"),
        (("--foreign", "ball.sdf"), "--foreign goes with one SCENE"),
        (("--report", "."), "cannot read 'results.json'"),
        (("--compare", ".", "."), "cannot read 'results.json'"),
    ],
)
def test_mistakes(bench: Bench, arguments: tuple[str, ...], message: str) -> None:
    result = bench(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr


def test_a_broken_file_of_results_is_not_written_over(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    file = tmp_path / "kept" / "results.json"
    for text, message in (("{", "is no file of bench results"), ('{"format": 99}', "is of format 99")):
        file.write_text(text)
        result = bench("--report", "kept")
        assert result.exit_code == 2 and message in result.stderr
        assert file.read_text() == text
