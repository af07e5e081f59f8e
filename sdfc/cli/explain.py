"""`sdfc explain`."""

from __future__ import annotations

from pathlib import Path

import click

from sdfc.cli import options


@click.command()
@options.scene_argument
@options.tracer_option
@options.json_option
def command(scene: Path, scene_format: str | None, tracer: str, as_json: bool) -> None:
    """Say what is proved of SCENE, how it will be traced, and why."""
    text = options.program(scene, scene_format).explanation(tracer)
    options.say(text, {"explanation": text.splitlines()}, as_json)
