"""`sdfc render --frames`: many pictures, or a film."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sdfc.cli import options
from sdfc.cli.values import parse_frames

if TYPE_CHECKING:
    from sdfc.api.reel import Reel

Function = TypeVar("Function", bound=Callable[..., Any])


def animation_options(function: Function) -> Function:
    """`--frames`, and what goes with it: `frames`, `fps`, `loop`, `resume`."""
    for option in (
        click.option("--resume", is_flag=True, help="Draw only the frames whose files are not there yet."),
        click.option("--loop", is_flag=True, help="End sweeps one frame early, so that it repeats without a halt."),
        click.option(
            "--fps",
            type=click.FloatRange(0.001, 1000.0),
            help="Frames a second: of a film, and of a param named time, which is frame / fps.  [default: 30]",
        ),
        click.option(
            "--frames",
            callback=lambda _, __, text: None if text is None else parse_frames(text),
            metavar="A..B",
            help="An animation of frames A to B; --set spin=0deg..360deg sweeps, and -o is out_%04d.png, .gif or .mp4.",
        ),
    ):
        function = option(function)
    return function


def check_still(output: Path, asked: dict[str, Any]) -> None:
    """Raise RequestError for what only an animation has."""
    from sdfc.api.animation import Sweep
    from sdfc.api.request import RequestError
    from sdfc.image.film import is_film

    advice = "say over which frames, as in --frames 0..120"
    for name, value in asked["settings"].items():
        if isinstance(value, Sweep):
            raise RequestError(f"'{name}' is swept from one value to another: {advice}")
    for name in ("fps", "loop", "resume"):
        if asked[name]:
            raise RequestError(f"--{name} is for animations: {advice}")
    if is_film(output):
        raise RequestError(f"'{output}' would be a film: {advice}")


def animate(scene: Path, scene_format: str | None, output: Path, asked: dict[str, Any]) -> dict[str, Any]:
    """Draw and write all frames; returns what there is to say of it."""
    from sdfc.api.animation import DEFAULT_FPS
    from sdfc.api.reel import open_reel
    from sdfc.api.request import View
    from sdfc.cli.progress import ProgressBar

    frames, size, fps, resume = asked["frames"], asked["size"], asked["fps"] or DEFAULT_FPS, asked["resume"]
    renderer = ""
    reel = open_reel(output, size, fps, asked["aovs"], asked["aov_format"], resume)
    with (
        closing(reel),
        options.program(scene, scene_format) as program,
        ProgressBar(f"rendering {len(frames)} frames") as progress,
    ):
        kept = _kept(reel, frames, scene) if resume else set()
        images = program.frames(
            frames,
            size,
            fps=fps,
            skip=kept,
            camera=View(**asked["camera"]),
            params=asked["settings"],
            **{name: asked[name] for name in ("loop", "samples", "tracer", "backend", "aovs")},
            progress=progress,
            note=_note,
        )
        for frame, image in zip((f for f in frames if f not in kept), images, strict=True):
            reel.add(frame, image)
            renderer = image.renderer
        written = reel.finish()
    return {
        "files": [str(path) for path in written],
        "size": list(size),
        "renderer": renderer,
        "frames": [frames[0], frames[-1]],
        "drawn": len(frames) - len(kept),
        "kept": len(kept),
    }


def _kept(reel: Reel, frames: range, scene: Path) -> set[int]:
    """The frames that an earlier run made. Those older than the scene are kept too, since imports cannot be judged."""
    made = {frame: when for frame in frames if (when := reel.made_at(frame)) is not None}
    if scene.is_file():
        older = sum(when < scene.stat().st_mtime for when in made.values())
        if older:
            _note(f"{older} of the {len(made)} frames that are kept are older than {scene}")
    return set(made)


def _note(text: str) -> None:
    click.echo(f"note: {text}", err=True)
