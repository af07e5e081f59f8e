"""`sdfc stress`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sdfc.cli import options
from sdfc.cli.values import parse_size

if TYPE_CHECKING:
    from sdfc.measure.stress.record import Family
    from sdfc.measure.stress.run import Outcome
    from sdfc.measure.way import Way

_REPORT, _DATA = "stress.md", "stress.json"


def _size(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    from sdfc.api.request import checked_size

    return checked_size(parse_size(text))


def _names(_: click.Context, __: click.Parameter, text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


@click.command()
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option(
    "--tracers",
    default="",
    callback=_names,
    metavar="NAMES",
    help="By default all; sphere+prepass is with the cone prepass, proven+rays with every closed form, auto what the"
    " planner chooses.",
)
@click.option("--size", default="48x27", show_default=True, callback=_size, metavar="WxH", help="Rays a case.")
@click.option("--random", "count", default=0, type=click.IntRange(0), metavar="N", help="Also so many random scenes.")
@click.option("--seed", default=0, show_default=True, type=int, help="Of the random scenes.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, file_okay=False),
    help="A folder for the report, in Markdown and JSON, and a picture of every failure.",
)
@click.option("--list", "only_list", is_flag=True, help="Say what cases there are.")
@options.json_option
def command(cases: tuple[str, ...], output: Path | None, as_json: bool, **asked: Any) -> None:
    """Trace what is hard for numbers of 24 bits, and judge it by certified truth.

    CASE is a family of cases, or FAMILY/CASE with * for anything. Exits with 1 if a tracer broke a guarantee that it
    gives.
    """
    from sdfc.measure.stress.run import chosen
    from sdfc.measure.stress.trees import grown
    from sdfc.measure.way import ways
    from sdfc.tracers import TRACERS

    grown_now = (grown(asked["count"], asked["seed"]),) if asked["count"] else ()
    named = chosen(cases) if cases or not grown_now else ()
    families = (*named, *grown_now)
    if asked["only_list"]:
        _list(families, as_json)
        return
    outcomes, device = _run(families, ways(asked["tracers"] or TRACERS), asked["size"], output)
    _say(outcomes, families, asked["size"], device, as_json)
    if any(outcome.is_broken for outcome in outcomes):
        click.get_current_context().exit(1)


def _list(families: tuple[Family, ...], as_json: bool) -> None:
    details = {f.name: {"about": f.doc, "cases": [c.name for c in f.cases]} for f in families}
    lines = [f"{f.name} ({len(f.cases)})\n    {f.doc}\n    {'; '.join(c.name for c in f.cases)}" for f in families]
    options.say("\n".join(lines), {"families": details}, as_json)


def _run(
    families: tuple[Family, ...], ways: tuple[Way, ...], size: tuple[int, int], output: Path | None
) -> tuple[list[Outcome], str]:
    """Every outcome, and what drew; with the files of the report, if they are wanted, also of what a Ctrl-C left."""
    from sdfc.api.renderer import GlRenderer
    from sdfc.cli.progress import ProgressBar
    from sdfc.measure.picture import Tracing
    from sdfc.measure.stress.run import stressed

    if output is not None:
        _made(output)
    renderer = GlRenderer()
    outcomes: list[Outcome] = []
    try:
        with ProgressBar("stress") as progress:
            for outcome in stressed(Tracing(renderer), families, ways, size, progress):
                outcomes.append(outcome)
    finally:
        if output is not None:
            _write(output, outcomes, families, ways, size, renderer.name)
        renderer.close()
    return outcomes, renderer.name


def _made(folder: Path) -> None:
    from sdfc.image.write import OutputError

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write into '{folder}': {error.strerror}") from error


def _write(
    folder: Path,
    outcomes: list[Outcome],
    families: tuple[Family, ...],
    ways: tuple[Way, ...],
    size: tuple[int, int],
    device: str,
) -> None:
    from sdfc.image.write import write_all
    from sdfc.measure.stress.mark import marked
    from sdfc.measure.stress.report import markdown, plain

    files: dict[Path, bytes] = {}
    pictures: dict[int, str] = {}
    for index, outcome in enumerate(outcomes):
        if outcome.trial is not None and outcome.failures:
            pictures[index] = f"{re.sub(r'[^A-Za-z0-9.+-]+', '-', f'{outcome.name}-{outcome.way}')}.png"
            files[folder / pictures[index]] = marked(outcome.trial)
    page = markdown(outcomes, families, [way.name for way in ways], pictures, device)
    files[folder / _REPORT] = page.encode()
    files[folder / _DATA] = (json.dumps(plain(outcomes, size, device), indent=2) + "\n").encode()
    write_all(files)


def _say(
    outcomes: list[Outcome], families: tuple[Family, ...], size: tuple[int, int], device: str, as_json: bool
) -> None:
    from sdfc.measure.stress.report import plain, told

    if as_json:
        details = plain(outcomes, size, device)
        click.echo(json.dumps({"ok": not details["broken"], **details}, indent=2))
        return
    ways = list(dict.fromkeys(outcome.way for outcome in outcomes))
    click.echo(told(outcomes, families, ways))
