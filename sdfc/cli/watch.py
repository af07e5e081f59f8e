"""`sdfc watch`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sdfc.cli import options
from sdfc.cli.values import parse_size

if TYPE_CHECKING:
    from sdfc.live.session import Update


def _size(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    return parse_size(text)


@click.command()
@options.scene_argument
@options.output_option("The picture: .png, or linear radiance as .exr or .npy.", True)
@click.option("--size", default="640x360", show_default=True, callback=_size, metavar="WxH", help="Pixels.")
@options.tracer_option
@click.option("--backend", default="auto", show_default=True, type=click.Choice(["auto", "gl", "cpu"]))
def command(
    scene: Path, scene_format: str | None, output: Path, size: tuple[int, int], tracer: str, backend: str
) -> None:
    """Render SCENE again whenever it is saved, or a file that it imports or reads; until Ctrl-C.

    A number that has been edited once is live from then on: to edit it again compiles nothing. A line for each save
    says what it needed and how long that took. What is wrong with the scene is told, and the last picture stays.
    """
    from sdfc.api.files import STDOUT, check_files
    from sdfc.api.request import RequestError
    from sdfc.api.source import kind_named
    from sdfc.cli.failure import report, warn
    from sdfc.live.session import Session, Update
    from sdfc.live.watch import watch

    if output == STDOUT:
        raise RequestError("a picture that changes needs a file: give -o a name")
    check_files(output, (), "npy")
    session = Session(output, size, tracer, backend, lambda text: click.echo(f"note: {text}", err=True))
    try:
        for told in watch(scene, kind_named(scene_format), session):
            if isinstance(told, Update):
                click.echo(_line(told))
                warn(told.warnings)
            else:
                click.echo(_stamped(f"{scene}: the last picture stays"))
                report(told.error, as_json=False)
    finally:
        session.close()


def _line(update: Update) -> str:
    """`12:30:05  numbers: 31 ms (reading 1, drawing 22, writing 8); 2 live numbers`."""
    times = ", ".join(f"{what} {took:.0f}" for what, took in update.times.items())
    cost = f": {update.milliseconds:.0f} ms ({times})" if times else ""
    live = f"; {update.live} live number{'s' if update.live > 1 else ''}" if update.live else ""
    return _stamped(f"{update.speed.value}{cost}{live}")


def _stamped(text: str) -> str:
    return f"{time.strftime('%H:%M:%S')}  {text}"
