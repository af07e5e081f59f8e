"""Options and arguments that several verbs share."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from sdfc.api import Program
    from sdfc.api.source import Input

Function = TypeVar("Function", bound=Callable[..., Any])

_PATH = click.Path(path_type=Path, allow_dash=True)


def scene_argument(function: Function) -> Function:
    """The scene and, where its name does not say it, its language: `scene` and `scene_format`."""
    language = click.option(
        "--format",
        "scene_format",
        type=click.Choice(["sdf", "csg"]),
        help="The scene's language; by default its ending says it, and standard input is sdf.",
    )
    return click.argument("scene", type=_PATH)(language(function))


def json_option(function: Function) -> Function:
    """`--json`: also for what goes wrong."""

    def remember(ctx: click.Context, _: click.Parameter, value: bool) -> bool:
        ctx.meta["sdfc.json"] = value
        return value

    return click.option("--json", "as_json", is_flag=True, is_eager=True, callback=remember, help="Say it in JSON.")(
        function
    )


def tracer_option(function: Function) -> Function:
    """`--tracer`."""
    return click.option(
        "--tracer",
        default="auto",
        show_default=True,
        help="How rays find surfaces (sdfc list tracers); auto: proven, or what is as right and found faster.",
    )(function)


def output_option(help_text: str, required: bool) -> Callable[[Function], Function]:
    """`-o`, a file, or `-` for standard output."""
    return click.option("-o", "--output", type=_PATH, required=required, help=help_text)


def given(scene: Path, scene_format: str | None) -> Input:
    """The scene's text."""
    from sdfc.api.source import from_path, kind_named

    return from_path(scene, kind_named(scene_format))


def program(scene: Path, scene_format: str | None) -> Program:
    """The scene, compiled as far as it takes to know that it is right; its warnings go to stderr."""
    from sdfc.api import load
    from sdfc.cli.failure import warn

    loaded = load(given(scene, scene_format))
    warn(loaded.warnings)
    return loaded


def say(words: str, details: dict[str, Any], as_json: bool) -> None:
    """The result of a verb, on stdout: in words, or as JSON."""
    click.echo(json.dumps({"ok": True, **details}, indent=2) if as_json else words)
