"""Values that change from frame to frame: sweeps, and a param named `time`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from sdfc.api.job import Job, part_of
from sdfc.api.quantity import Quantity, parse_quantity
from sdfc.api.request import RequestError, Setting, View, checked_params

if TYPE_CHECKING:
    from sdfc.api.renderer import Progress
    from sdfc.image.picture import Image
    from sdfc.scene.model import Param

DEFAULT_FPS = 30.0
MOST_FRAMES = 1_000_000
TIME = "time"  # the param that is the clock, in seconds, where a scene has it
_DOTS = ".."

Values: TypeAlias = dict[str, tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Sweep:
    """From `start` at the first frame to `end` at the last, linearly, each component for itself."""

    start: Setting
    end: Setting


Change: TypeAlias = "Setting | Sweep"
"""What a param is through an animation: one value, or a sweep. A text with `..` in it is a sweep: `0deg..360deg`."""


def parse_change(text: str) -> Quantity | Sweep:
    """`0.5`, or a sweep: `0..1`, `0deg..360deg`, `0,0,0..1,2,3`, `#f00..#00f` (colours are mixed as light)."""
    start, dots, end = text.partition(_DOTS)
    if not dots:
        return parse_quantity(text)
    if not start.strip() or not end.strip():
        raise RequestError(f"'{text}' is not a sweep like 0..1 or 0deg..360deg")
    return Sweep(parse_quantity(start), parse_quantity(end))


@dataclass(frozen=True, slots=True)
class Timeline:
    """Which frames there are, and how many a second. With `loop` a sweep ends one frame after the last one.

    So the last frame of a full turn is not the first one again, and the animation repeats without a halt.
    """

    frames: range
    fps: float = DEFAULT_FPS
    loop: bool = False

    def __post_init__(self) -> None:
        if not 0 < len(self.frames) <= MOST_FRAMES:
            raise RequestError(f"an animation has between 1 and {MOST_FRAMES} frames, not {len(self.frames)}")
        if not (0.0 < self.fps < math.inf):
            raise RequestError(f"fps must be a number above zero, not {self.fps:g}")

    def share(self, frame: int) -> float:
        """How far a sweep has come at a frame, 0 to 1."""
        steps = len(self.frames) - (0 if self.loop else 1)
        return self.frames.index(frame) / steps if steps else 0.0

    def seconds(self, frame: int) -> float:
        """When a frame is: frame 0 is at 0."""
        return frame / self.fps


@dataclass(frozen=True, slots=True)
class Motion:
    """The value of every param at every frame of a timeline."""

    timeline: Timeline
    start: Values
    end: Values
    has_clock: bool  # the param `time` follows the timeline

    def values(self, frame: int) -> Values:
        """Every param's value at a frame."""
        share = self.timeline.share(frame)
        made = {name: _between(value, self.end[name], share) for name, value in self.start.items()}
        if self.has_clock:
            made[TIME] = (self.timeline.seconds(frame),)
        return made

    @property
    def is_still(self) -> bool:
        """Whether all frames are the same picture."""
        return self.start == self.end and not self.has_clock


def motion_of(params: tuple[Param, ...], changes: Mapping[str, Change], timeline: Timeline) -> Motion:
    """The motion that is asked for. Raises RequestError where any frame would have a value outside its range."""
    ends = {name: _ends(change) for name, change in changes.items()}
    start = checked_params(params, {name: first for name, (first, _) in ends.items()})
    end = checked_params(params, {name: last for name, (_, last) in ends.items()})
    has_clock = TIME not in changes and any(_is_clock(param) for param in params)
    if has_clock:
        for frame in (timeline.frames[0], timeline.frames[-1]):
            _check_time(params, frame, timeline)
    return Motion(timeline, start, end, has_clock)


def pictures(
    job: Job, view: View, frames: Sequence[int], values: Callable[[int], Values], progress: Progress | None
) -> Iterator[Image]:
    """The frames' pictures, one after the other, by one compiled scene on one device's frame buffers."""
    with job.renderer.kept_frames():
        for index, frame in enumerate(frames):
            yield job.image(view, values(frame), part_of(progress, index, len(frames)))


def _ends(change: Change) -> tuple[Setting, Setting]:
    match change:
        case str() if _DOTS in change:
            return _ends(parse_change(change))
        case Sweep(start, end):
            return start, end
        case _:
            return change, change


def _is_clock(param: Param) -> bool:
    return param.name == TIME and param.type.size == 1 and param.unit != "angle"


def _check_time(params: tuple[Param, ...], frame: int, timeline: Timeline) -> None:
    try:
        checked_params(params, {TIME: timeline.seconds(frame)})
    except RequestError as error:
        raise RequestError(f"{error} (at frame {frame}, with {timeline.fps:g} frames a second)") from None


def _between(start: tuple[float, ...], end: tuple[float, ...], share: float) -> tuple[float, ...]:
    """Held between its ends: rounding must not leave a param's range."""
    return tuple(
        min(max(first * (1.0 - share) + last * share, min(first, last)), max(first, last))
        for first, last in zip(start, end, strict=True)
    )
