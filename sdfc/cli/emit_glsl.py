"""`sdfc emit-glsl`."""

from __future__ import annotations

from pathlib import Path

import click

from sdfc.cli import options


@click.command()
@options.scene_argument
@options.output_option("Where to write it; standard output by default.", required=False)
@click.option("--target", default="glsl450", show_default=True, type=click.Choice(["glsl450"]))
@click.option("--stage", default="fragment", show_default=True, type=click.Choice(["fragment", "compute"]))
@options.tracer_option
@options.json_option
def command(
    scene: Path,
    scene_format: str | None,
    output: Path | None,
    target: str,
    stage: str,
    tracer: str,
    as_json: bool,
) -> None:
    """Write SCENE as one complete shader."""
    to_stdout = output is None or str(output) == "-"
    if not to_stdout:
        from sdfc.image.write import check_writable

        check_writable(Path(str(output)))
    text = options.program(scene, scene_format).glsl(target, stage, tracer)
    if output is None or to_stdout:
        options.say(text.removesuffix("\n"), {"target": target, "stage": stage, "text": text}, as_json)
        return
    from sdfc.image.write import write

    write(output, text.encode())
    if as_json:
        options.say("", {"target": target, "stage": stage, "files": [str(output)]}, True)
