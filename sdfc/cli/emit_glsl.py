"""`sdfc emit-glsl`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sdfc.cli import options
from sdfc.cli.values import parse_settings


def _settings(_: click.Context, __: click.Parameter, texts: tuple[str, ...]) -> dict[str, Any]:
    return parse_settings(texts)


@click.command()
@options.scene_argument
@options.output_option("Where to write it; standard output by default.", required=False)
@click.option(
    "--target", default="glsl450", show_default=True, metavar="NAME", help="For which language (sdfc list targets)."
)
@click.option(
    "--part",
    default="full",
    show_default=True,
    metavar="PART",
    help="full: a complete shader; tracer or field: functions for a shader of your own.",
)
@click.option("--stage", metavar="STAGE", help="fragment, compute or vertex; by default the target's first.")
@click.option("--prefix", metavar="P", help="What all global names begin with; by default, in parts, the scene's name.")
@click.option("--bake", is_flag=True, help="Params become constants.")
@click.option(
    "--set",
    "settings",
    multiple=True,
    callback=_settings,
    metavar="NAME=VALUE",
    help="With --bake: another value for a param: 0.5, 30deg, #ff8800, 1,2,3. May be repeated.",
)
@options.tracer_option
@options.json_option
def command(scene: Path, scene_format: str | None, output: Path | None, as_json: bool, **asked: Any) -> None:
    """Write SCENE as GLSL: a complete shader, or a part of one, for the target."""
    from sdfc.api.emission import files_of

    to = None if output is None or str(output) == "-" else output
    if to is not None:
        from sdfc.image.write import check_writable

        check_writable(to)
    asked["params"] = asked.pop("settings")
    program = options.program(scene, scene_format)
    files = files_of(program, to, **asked)
    told = {name: asked[name] for name in ("target", "part")}
    if to is None:
        ((stage, text),) = files.values()
        options.say(text.removesuffix("\n"), {**told, "stage": stage, "text": text}, as_json)
        return
    from sdfc.image.write import check_no_source, write_all

    sources = [program.scene.source.name, *program.scene.files]
    check_no_source([path for path in files if path is not None], sources)
    write_all({path: text.encode() for path, (_, text) in files.items() if path is not None})
    if as_json:
        stages = [stage for stage, _ in files.values()]
        options.say("", {**told, "stage": stages[0], "files": [str(path) for path in files]}, True)
