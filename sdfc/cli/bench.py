"""`sdfc bench`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sdfc.cli import options
from sdfc.cli.failure import EXIT_BUG
from sdfc.cli.values import parse_size

if TYPE_CHECKING:
    from sdfc.measure.bench.plan import Wanted
    from sdfc.measure.bench.store import Store

Value = TypeVar("Value")
_FOLDER = click.Path(path_type=Path, exists=True, file_okay=False)


def _listed(parse: Callable[[str], Value]) -> Callable[[click.Context, click.Parameter, str | None], Any]:
    """A callback for values between commas; None where nothing was given."""

    def values(_: click.Context, __: click.Parameter, text: str | None) -> tuple[Value, ...] | None:
        if text is None:
            return None
        found = tuple(parse(part.strip()) for part in text.split(",") if part.strip())
        if not found:
            raise click.BadParameter("there is nothing in the list")
        return found

    return values


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise click.BadParameter(f"'{text}' is not a number") from None
    if not 0.0 < value < float("inf"):
        raise click.BadParameter(f"'{text}' is not above zero")
    return value


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise click.BadParameter(f"'{text}' is not a number of steps")
    return int(text)


def _size(text: str) -> tuple[int, int]:
    from sdfc.api.request import checked_size

    return checked_size(parse_size(text))


def _grid(_: click.Context, __: click.Parameter, text: str | None) -> tuple[int, int] | None:
    return None if text is None else _size(text)


@click.command()
@click.argument("scenes", nargs=-1, type=click.Path(path_type=Path, exists=True, dir_okay=False), metavar="[SCENE]...")
@options.output_option("The folder of results, gone on with where it has some; with --report, the page.", False)
@click.option(
    "--tracers",
    callback=_listed(str),
    metavar="LIST",
    help="Such as sphere,relaxed:omega=1.4,sphere+prepass,proven+rays,auto (what the planner chooses). By default all.",
)
@click.option("--sizes", callback=_listed(_size), metavar="LIST", help="WxH. By default 640x360.")
@click.option(
    "--tolerances",
    callback=_listed(_positive),
    metavar="LIST",
    help="Times what sdfc asks for, which is 1/64 of half a pixel. By default 1,8,64.",
)
@click.option(
    "--budgets",
    callback=_listed(_count),
    metavar="LIST",
    help="Also measure with at most so many steps a ray: 8,16,32,64,128,256. By default so, on a few known scenes.",
)
@click.option("--repeat", type=click.IntRange(1), help="Frames of each, unless they take long. By default 7.")
@click.option("--grid", callback=_grid, metavar="WxH", help="The picture whose every ray is judged. By default 160x90.")
@click.option("--random", type=click.IntRange(1), help="How many pixels of the timed frame are judged: 2000.")
@click.option("--all-rays", is_flag=True, help="Judge so many even where their truth takes minutes (chess, temple).")
@click.option("--backend", default="gl", show_default=True, type=click.Choice(["gl"]), help="What draws.")
@click.option("--quick", is_flag=True, help="Few scenes, small, one tolerance: a minute.")
@click.option(
    "--foreign",
    multiple=True,
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    metavar="FILE",
    help="Somebody's own shader of the one SCENE, `float map(vec3 p)` or whole (bench/README.md).",
)
@click.option("--compare", nargs=2, type=_FOLDER, metavar="DIR1 DIR2", help="Show two runs side by side, and exit.")
@click.option("--report", type=_FOLDER, metavar="DIR", help="Write the page about a run, and exit.")
@click.pass_context
def command(ctx: click.Context, /, output: Path | None, backend: str, **asked: Any) -> None:
    """Measure time against error, of every tracer on every SCENE, judged by certified truth.

    Without a SCENE: all of the repository's scenes. Without -o the tables are only printed.

    --compare exits with 1 where a cell of DIR2 has more wrong rays than in DIR1, or is not legal any more; never
    for times.
    """
    if asked["compare"]:
        ctx.exit(_compare(*asked["compare"]))
    if asked["report"]:
        _report(asked["report"], output)
        return
    if _bench(_wanted(asked), output).failures:
        ctx.exit(EXIT_BUG)


def _wanted(asked: dict[str, Any]) -> Wanted:
    """What is to be measured: what was asked for, and sensible values for the rest."""
    from dataclasses import replace

    from sdfc.measure.bench import plan
    from sdfc.measure.way import ways

    if asked["foreign"] and len(asked["scenes"]) != 1:
        raise click.UsageError("--foreign goes with one SCENE, which the shader shows")
    usual = plan.quick() if asked["quick"] else plan.full()
    if asked["scenes"]:
        usual = replace(usual, scenes=asked["scenes"], budgeted=(), swept=(), aside=1)
    else:
        usual = replace(usual, scenes=plan.usual_scenes(plan.QUICK if asked["quick"] else ()))
    if asked["tracers"] is not None:
        usual = replace(usual, tracers=tuple(way.name for way in ways(asked["tracers"])), swept=())
    if asked["budgets"] is not None and asked["scenes"]:
        usual = replace(usual, budgeted=tuple(path.name for path in asked["scenes"]))
    if asked["all_rays"]:
        usual = replace(usual, most=float("inf"))
    same = ("sizes", "tolerances", "budgets", "repeat", "grid", "random", "foreign")
    return replace(usual, **{name: asked[name] for name in same if asked[name]})


def _bench(wanted: Wanted, folder: Path | None) -> Store:
    from sdfc.cli.progress import ProgressBar
    from sdfc.measure.bench import plots, tables
    from sdfc.measure.bench.run import bench

    said: set[str] = set()

    def note(text: str) -> None:
        if text not in said:  # once, not once a scene
            click.echo(f"note: {text}", err=True)
        said.add(text)

    with ProgressBar("measuring") as bar:
        store = bench(wanted, folder, lambda done, count, _: bar(done / count), note)
    click.echo(tables.page(store), nl=False)
    if folder is not None:
        _finish(store, folder)
        if plots.are_there(note):
            plots.all_of(store, folder)
    return store


def _finish(store: Store, folder: Path) -> None:
    from sdfc.image.write import write
    from sdfc.measure.bench import tables

    write(folder / "results.md", tables.page(store).encode())


def _compare(before: Path, after: Path) -> int:
    from sdfc.measure.bench import tables
    from sdfc.measure.bench.store import read

    text, is_worse = tables.comparison(read(before), read(after))
    click.echo(text)
    return 1 if is_worse else 0


def _report(folder: Path, output: Path | None) -> None:
    from sdfc.image.write import write
    from sdfc.measure.bench.report import report
    from sdfc.measure.bench.store import read

    page = output or Path("-")
    text = report(read(folder), folder, page)
    if page == Path("-"):
        click.echo(text, nl=False)
    else:
        write(page, text.encode())
