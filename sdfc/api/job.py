"""A scene that is ready to be drawn: what stays the same from picture to picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdfc.api.renderer import GlRenderer, Progress, Renderer, Shot
from sdfc.api.request import View
from sdfc.diagnostics import DeviceError
from sdfc.image.picture import Image

if TYPE_CHECKING:
    from sdfc.image.picture import Array
    from sdfc.pipeline import Compiled

FLOAT32 = 2.0**-22  # of the scene's radius: what hits are right to (plan.GROW)
FEWEST_DIGITS = 4.0 * FLOAT32  # the narrowest pixel that float32 is good for


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A compiled scene on a renderer, for pictures of one size, with these images beside the colour."""

    renderer: Renderer
    compiled: Compiled
    size: tuple[int, int]
    samples: int
    aovs: tuple[str, ...]

    def image(self, view: View, values: Mapping[str, tuple[float, ...]], progress: Progress | None) -> Image:
        """One picture. `values` has every param's; `progress` is told the share done, and may raise to stop."""
        shot = Shot(self.compiled, view, values, self.size)
        passes = self.samples + bool(self.aovs)
        parts = [part_of(progress, sample, passes) for sample in range(self.samples)]
        colour = _accumulated(self.renderer, shot, parts)
        last = part_of(progress, self.samples, passes)
        kept = _aovs(self.renderer, shot, self.aovs, last) if self.aovs else {}
        return Image(colour, kept, tuple(self.compiled.materials), self.renderer.name)

    def tell(self, view: View, values: Mapping[str, tuple[float, ...]], note: Callable[[str], None]) -> None:
        """Say what such a picture will not have, though it may have been expected."""
        if isinstance(self.renderer, GlRenderer):
            _note_digits(Shot(self.compiled, view, values, self.size), note)
        elif not self.compiled.plan.tracer.needs_steps:
            name = self.compiled.plan.tracer.name
            note(f"NumPy traces by the step rules of 'proven' alone: '{name}' is for OpenGL")


def part_of(progress: Progress | None, index: int, count: int) -> Progress | None:
    """Progress of one of `count` equal parts, as progress of the whole."""
    if progress is None:
        return None
    whole = progress

    def report(share: float) -> None:
        whole((index + share) / count)

    return report


def _note_digits(shot: Shot, note: Callable[[str], None]) -> None:
    """Say so where float32 has not enough digits for what is looked at: small things in a scene that is very large."""
    pixel, radius = shot.compiled.pixel(shot.view, shot.params, shot.size), shot.compiled.frame.radius
    if pixel < FEWEST_DIGITS:
        note(
            f"a pixel is {pixel * radius:.2g} wide where the camera looks, but in a scene of radius {radius:.3g} "
            f"float32 is right to {FLOAT32 * radius:.2g}: expect faults (--backend cpu has float64)"
        )


def _accumulated(renderer: Renderer, shot: Shot, parts: Sequence[Progress | None]) -> Array:
    """The mean radiance of one sample for each part of the progress, float32 (height, width, 3)."""
    import numpy as np

    total = np.zeros((shot.size[1], shot.size[0], 3))
    for sample, part in enumerate(parts):
        total += renderer.radiance(shot, sample, part)[..., :3]
    if not np.isfinite(total).any():
        raise DeviceError(f"{renderer.name} drew nothing but NaN")
    return (total / len(parts)).astype(np.float32)


def _aovs(renderer: Renderer, shot: Shot, wanted: tuple[str, ...], progress: Progress | None) -> dict[str, Array]:
    """The images beside the colour that are wanted, in the forms that Image documents."""
    import numpy as np

    if set(wanted) <= {"depth", "steps"}:
        first = normal = position = renderer.depth(shot, progress)
    else:
        first, normal, position, _ = renderer.probe(shot, progress)
    hit = first[..., 3] > 0.5
    made: dict[str, Callable[[], Array]] = {
        "depth": lambda: np.where(hit, first[..., 0], np.inf).astype(np.float32),
        "normal": lambda: np.where(hit[..., None], normal[..., :3], 0.0).astype(np.float32),
        "position": lambda: np.where(hit[..., None], position[..., :3], np.nan).astype(np.float32),
        "material": lambda: np.where(hit, np.round(first[..., 2]), -1).astype(np.int32),
        "steps": lambda: np.round(first[..., 1]).astype(np.int32),
    }
    return {name: made[name]() for name in wanted}
