"""`sdfc watch`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sdfc.cli import options
from sdfc.cli.values import parse_size

if TYPE_CHECKING:
    from sdfc.live.pages import Pages
    from sdfc.live.session import Session
    from sdfc.live.update import Update
    from sdfc.live.watch import Failure

_PORT = 8642
_SERVE = "--serve"


def _size(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    return parse_size(text)


class _Command(click.Command):
    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        return super().parse_args(ctx, _with_port(args))


def _with_port(arguments: Sequence[str]) -> list[str]:
    """`--serve SCENE`: a scene's name is no port."""
    behind = [*arguments[1:], ""]
    return [
        f"{_SERVE}={_PORT}" if word == _SERVE and not following.lstrip("+-").isdigit() else word
        for word, following in zip(arguments, behind, strict=True)
    ]


@click.command(cls=_Command)
@options.scene_argument
@options.output_option("The picture: .png, or linear radiance as .exr or .npy.", False)
@click.option(
    _SERVE,
    "port",
    type=click.IntRange(0, 65535),
    metavar="[PORT]",
    help=f"Show it on a page of this machine, by default at http://127.0.0.1:{_PORT}/ (0: any free port).",
)
@click.option("--size", default="640x360", show_default=True, callback=_size, metavar="WxH", help="Pixels, of -o.")
@options.tracer_option
@click.option("--backend", default="auto", show_default=True, type=click.Choice(["auto", "gl", "cpu"]))
def command(
    scene: Path,
    scene_format: str | None,
    output: Path | None,
    port: int | None,
    size: tuple[int, int],
    tracer: str,
    backend: str,
) -> None:
    """Render SCENE again whenever it is saved, or a file that it imports or reads; until Ctrl-C.

    A number that has been edited once is live from then on: to edit it again compiles nothing. A line for each save
    says what it needed and how long that took. What is wrong with the scene is told, and the last picture stays.
    """
    from sdfc.api.source import kind_named
    from sdfc.live.watch import first_look, watch

    kind = kind_named(scene_format)
    _check(output, port, size, tracer)
    first_look(scene, kind)
    with ExitStack() as stack:
        session, pages = _begun(stack, port, output, size, tracer, backend)
        for told in watch(scene, kind, session):
            _tell(told, scene, pages)


def _begun(
    stack: ExitStack, port: int | None, output: Path | None, size: tuple[int, int], tracer: str, backend: str
) -> tuple[Session, Pages | None]:
    """What shows the scene, and the server for its pages; they end with the stack."""
    from sdfc.live.saves import Bell
    from sdfc.live.session import Session
    from sdfc.live.worker import Worker

    bell = Bell()
    pages = _opened(port, bell.ring)
    if pages is not None:
        stack.callback(pages.close)
    worker = stack.enter_context(Worker(_note)) if backend != "cpu" else None
    session = Session(output, size, tracer, backend, _note, pages, worker, bell)
    stack.callback(session.close)
    return session, pages


def _check(output: Path | None, port: int | None, size: tuple[int, int], tracer: str) -> None:
    """Raise RequestError for what cannot be, before anything is served."""
    from sdfc.api.files import STDOUT, check_files
    from sdfc.api.request import RequestError, checked_size, checked_tracer

    if output is None and port is None:
        raise RequestError("a picture needs a place: give -o a file's name, or --serve for a page in a browser")
    if output == STDOUT:
        raise RequestError("a picture that changes needs a file: give -o a name")
    if output is not None:
        check_files(output, (), "npy")
    checked_size(size)
    checked_tracer(tracer)


def _tell(told: Update | Failure, scene: Path, pages: Pages | None) -> None:
    """On the terminal, and on the pages."""
    from sdfc.cli.failure import account, warn
    from sdfc.live.update import Update
    from sdfc.live.watch import Failure

    match told:
        case Update():
            click.echo(line := _line(told))
            warn(told.warnings)
        case Failure():
            click.echo(line := _stamped(f"{scene}: the last picture stays"))
            click.echo(words := account(told.error)[0], err=True)
            if pages is not None:
                pages.tell_errors(words, told.error)
    if pages is not None:
        pages.tell(line)


def _note(text: str) -> None:
    click.echo(f"note: {text}", err=True)


def _opened(port: int | None, wanted: Callable[[], None]) -> Pages | None:
    """The server, and the line that says where. Raises RequestError where the port is not to be had."""
    if port is None:
        return None
    from sdfc.live.pages import Pages

    pages = Pages(port, wanted)
    click.echo(f"serving {pages.address}")
    return pages


def _line(update: Update) -> str:
    """`12:30:05  numbers: 31 ms (reading 1, drawing 22, writing 8); 2 live numbers`."""
    times = ", ".join(f"{what} {took:.0f}" for what, took in update.times.items())
    cost = f": {update.milliseconds:.0f} ms ({times})" if times else ""
    live = f"; {update.live} live number{'s' if update.live > 1 else ''}" if update.live else ""
    return _stamped(f"{update.speed.value}{cost}{live}")


def _stamped(text: str) -> str:
    return f"{time.strftime('%H:%M:%S')}  {text}"
