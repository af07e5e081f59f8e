"""`sdfc render`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import click

from sdfc.cli import options
from sdfc.cli.animate import animate, animation_options, check_still
from sdfc.cli.values import parse_camera, parse_changes, parse_size


def _size(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    return parse_size(text)


def _settings(_: click.Context, __: click.Parameter, texts: tuple[str, ...]) -> dict[str, Any]:
    return parse_changes(texts)


def _camera(_: click.Context, __: click.Parameter, texts: tuple[str, ...]) -> dict[str, Any]:
    return parse_camera(texts)


def _aovs(_: click.Context, __: click.Parameter, text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


@click.command()
@options.scene_argument
@options.output_option("The picture: .png, or linear radiance as .exr or .npy; - for a PNG on standard output.", True)
@click.option("--size", default="1280x720", show_default=True, callback=_size, metavar="WxH", help="Pixels.")
@click.option(
    "--set",
    "settings",
    multiple=True,
    callback=_settings,
    metavar="NAME=VALUE",
    help="Give a param of the scene another value: 0.5, 30deg, #ff8800, 1,2,3; or sweep it over the frames of an"
    " animation: 0deg..360deg. May be repeated.",
)
@click.option(
    "--camera",
    multiple=True,
    callback=_camera,
    metavar="VALUES",
    help="Change the camera: 'eye=3,2,4 target=0,0,0 up=0,1,0 fov=35deg', or height=2 for an orthographic one.",
)
@options.tracer_option
@click.option("--samples", default=1, show_default=True, type=click.IntRange(1), help="Rays a pixel.")
@click.option(
    "--aov",
    "aovs",
    default="",
    callback=_aovs,
    metavar="NAMES",
    help="More images, kept beside the picture: depth,normal,position,material,steps.",
)
@click.option("--aov-format", default="npy", show_default=True, type=click.Choice(["npy", "exr", "png"]))
@click.option("--backend", default="auto", show_default=True, type=click.Choice(["auto", "gl", "cpu"]))
@animation_options
@options.json_option
def command(scene: Path, scene_format: str | None, output: Path, **asked: Any) -> None:
    """Render SCENE to a picture, or to an animation."""
    started = time.perf_counter()
    if asked["frames"] is None:
        check_still(output, asked)
        details = _picture(scene, scene_format, output, asked)
    else:
        details = animate(scene, scene_format, output, asked)
    if asked["as_json"]:
        options.say("", {**details, "seconds": round(time.perf_counter() - started, 3)}, True)


def _picture(scene: Path, scene_format: str | None, output: Path, asked: dict[str, Any]) -> dict[str, Any]:
    from sdfc.api.files import check_files, write_files
    from sdfc.api.request import View
    from sdfc.cli.progress import ProgressBar

    check_files(output, asked["aovs"], asked["aov_format"])
    view = View(**asked["camera"])
    with options.program(scene, scene_format) as program, ProgressBar("rendering") as progress:
        image = program.render(
            asked["size"],
            camera=view,
            params=asked["settings"],
            samples=asked["samples"],
            tracer=asked["tracer"],
            backend=asked["backend"],
            aovs=asked["aovs"],
            progress=progress,
            note=lambda text: click.echo(f"note: {text}", err=True),
        )
    written = write_files(image, output, asked["aov_format"])
    return {
        "files": [str(path) for path in written],
        "size": list(image.size),
        "renderer": image.renderer,
        "materials": list(image.materials),
    }
