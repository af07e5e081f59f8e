"""What competes on a scene: programs that can be drawn at any size and tolerance."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, Protocol, TypeAlias, TypeVar

from sdfc import pipeline
from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.diagnostics import InternalError, SceneError
from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram
from sdfc.measure.bench.answers import RAYS, Size
from sdfc.measure.way import way
from sdfc.pipeline import Compiled, Options
from sdfc.scene.model import Scene

ENTRY = "depth"  # primary rays and nothing else: what every tracer is compared by

Planned: TypeAlias = tuple[Options, str] | SceneError  # the planner's choice and its reason, or why there is none
Result = TypeVar("Result")


class Reply(Enum):
    """What a shader's first image says."""

    DEPTH = "depth"  # depth in the scene's units, steps, evaluations, whether it hit
    COVER = "colour"  # a colour whose alpha says whether it hit
    NOTHING = "nothing"


class Drawing(Protocol):
    """A program with its frame, ready to draw."""

    def draw(self) -> None:
        """One whole frame, and wait for it."""

    def read(self, attachment: int = 0) -> Any:
        """An image of the last frame, float32 (height, width, 4), rows from the top."""


class Entrant(Protocol):
    """A competitor. `text` is the shader, `costs` the milliseconds of the phases `compile` and `emit`."""

    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def costs(self) -> Mapping[str, float]: ...
    @property
    def note(self) -> str: ...
    @property
    def reply(self) -> Reply: ...

    def drawing(self, size: Size, tolerance: float) -> AbstractContextManager[Drawing]:
        """At a size, for a tolerance (times what sdfc asks for)."""


@dataclass(frozen=True, slots=True)
class Illegal:
    """A tracer that may not trace the scene."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Traced:
    """A scene by one of our tracers."""

    name: str
    compiled: Compiled
    renderer: GlRenderer
    text: str
    costs: Mapping[str, float] = field(default_factory=dict)
    note: str = ""

    @property
    def reply(self) -> Reply:
        return Reply.DEPTH

    @contextmanager
    def drawing(self, size: Size, tolerance: float, entry: str = ENTRY, attachments: int = 1) -> Iterator[Drawing]:
        """See Entrant. No tolerance asks for another program: the pixel that all is judged by grows instead."""
        with self.renderer.prepared(Shot(self.compiled, View(), {}, size), entry, attachments) as prepared:
            yield replace(prepared, uniforms=coarser(prepared.uniforms, tolerance))


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """A program of our own making, with its frame."""

    frame: Frame
    program: FragmentProgram
    uniforms: Mapping[str, Any]

    def draw(self) -> None:
        """See Drawing."""
        self.frame.draw_whole(self.program, self.uniforms)

    def read(self, attachment: int = 0) -> Any:
        """See Drawing."""
        return self.frame.read(attachment)


class Floor:
    """Rays that are made, and not traced: below this no tracer can be."""

    name = "floor"
    note = "rays that are made, and not traced"
    reply = Reply.NOTHING
    text = RAYS
    costs: Mapping[str, float] = {}

    def __init__(self, compiled: Compiled, device: Device) -> None:
        self._compiled = compiled
        self._device = device
        self._program: FragmentProgram | None = None

    @contextmanager
    def drawing(self, size: Size, tolerance: float) -> Iterator[Drawing]:
        """See Entrant."""
        if self._program is None:
            self._program = FragmentProgram(self._device, self.text, self._compiled.vertex())
        uniforms = coarser(self._compiled.uniforms(View(), {}, size), tolerance)
        with Frame(self._device, *size, 1) as frame:
            yield Drawn(frame, self._program, uniforms)


def coarser(uniforms: Mapping[str, Any], tolerance: float) -> dict[str, Any]:
    """The uniforms of a picture whose pixels are so many times larger, to who asks how near is near enough."""
    size, growth, perspective = uniforms["pixel"]
    return {**uniforms, "pixel": (size * tolerance, growth * tolerance, perspective)}


def entrant(
    scene: Scene, spec: str, budget: int | None, renderer: GlRenderer, planned: Planned | None = None
) -> Traced | Illegal:
    """The scene compiled for a tracer, or for what the planner chooses (`auto`)."""
    try:
        options, note = asked(scene, spec, planned)
        wanted = replace(options, most_steps=budget)
        compiled, proving = timed(lambda: pipeline.compile_scene(scene, wanted))
        text, emitting = timed(lambda: "".join(compiled.glsl(entry) for entry in _entries(compiled)))
    except SceneError as error:
        return Illegal(spec, "; ".join(d.message for d in error.diagnostics))
    return Traced(spec, compiled, renderer, text, {"compile": proving, "emit": emitting}, note)


def plan(scene: Scene, renderer: GlRenderer) -> Planned:
    """What the planner chooses: on a device of its own, lest its pilots have compiled what is to be timed."""
    from sdfc.api.choose import decide, options_of

    try:
        decision = decide(scene, renderer, pilot=True)
    except SceneError as error:
        return error
    return options_of(decision.chosen), f"{decision.chosen.name}: {decision.reason}"


def asked(scene: Scene, spec: str, planned: Planned | None) -> tuple[Options, str]:
    """The compiler's options for a spec (`relaxed:omega=1.4`, `sphere+prepass`, `auto`), and a remark."""
    options = way(spec).options
    if options is not None:
        return options, ""
    match planned:
        case SceneError():
            raise planned
        case None:
            raise InternalError("nothing was planned")
        case choice:
            return choice


def _entries(compiled: Compiled) -> tuple[str, ...]:
    return (ENTRY, "cone") if compiled.plan.prepass else (ENTRY,)


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """The result, and the milliseconds that it took."""
    started = time.perf_counter()
    result = work()
    return result, 1e3 * (time.perf_counter() - started)
