"""`sdfc check`."""

from __future__ import annotations

from pathlib import Path

import click

from sdfc.cli import options
from sdfc.cli.failure import described


@click.command()
@options.scene_argument
@click.option(
    "--show",
    "form",
    type=click.Choice(["syntax", "shape", "field", "plan", "glsl"]),
    help="Print the scene in one of the compiler's forms.",
)
@click.option("--after", metavar="PASS", help="With --show shape: as it is after this pass.")
@options.json_option
def command(scene: Path, scene_format: str | None, form: str | None, after: str | None, as_json: bool) -> None:
    """Say what is wrong with SCENE; show what the compiler makes of it."""
    if after is not None and form != "shape":
        raise click.UsageError("--after goes with --show shape")
    from sdfc.api.inspect import show, summary

    if form is not None:
        text = show(options.given(scene, scene_format), form, after)
        options.say(text, {"form": form, "text": text}, as_json)
        return
    program = options.program(scene, scene_format)
    facts = summary(program)
    words = ", ".join(f"{count} {what}" for what, count in facts.items())
    details = {"file": str(scene), **facts, "diagnostics": [described(w) for w in program.warnings]}
    options.say(f"{scene}: nothing wrong ({words})", details, as_json)
