"""Which way to trace a scene: predicted from its formulas and the device's speed, and tried where that is not enough.

A pilot (a few small frames with each candidate that may be best) is worth it only for much work: it compiles shaders.
What it found is remembered, by the shaders' text and the device.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from sdfc import cache
from sdfc.api.renderer import GlRenderer, Prepared, Shot
from sdfc.api.request import View
from sdfc.plan.candidates import CLOSE, UNMEASURED, Candidate, Speeds, candidates

if TYPE_CHECKING:
    from sdfc.pipeline import Compiled, Options
    from sdfc.scene.model import Scene

PILOT_SIZE = (192, 108)  # smaller, and a frame's own cost would decide
_ROUNDS = 9
_MOST_TRIED = 4
_TO_WIN = 1.1  # by so much must one more stage be faster in a small frame, whose time is a little uncertain
_NO_WORSE = 0.02  # of the pilot's rays may be answered otherwise than by `proven`: edges, and what is contested
WORTH_A_PILOT = 20_000_000  # rays: about a second of drawing, what two or three more shaders take to compile


@dataclass(frozen=True, slots=True)
class Decision:
    """What was chosen, of which candidates, and why. `pilot`: milliseconds a pilot frame of those that were tried."""

    chosen: Candidate
    candidates: tuple[Candidate, ...]
    speeds: Speeds
    pilot: dict[str, float]
    reason: str


def decide(scene: Scene, renderer: GlRenderer | None, pilot: bool) -> Decision:
    """Choose. Without a renderer the speeds are assumed; without `pilot` what is close is decided by prediction,
    unless an earlier pilot is remembered."""
    from sdfc import pipeline

    speeds = UNMEASURED if renderer is None else _speeds(renderer)
    plain = pipeline.compile_scene(scene)
    dear = pipeline.compile_scene(scene, pipeline.Options(rays="all"))
    is_dearer = plain.glsl("depth") != dear.glsl("depth")
    with pipeline.deep_recursion():
        found = candidates(plain.plan, scene.values, speeds, dear.plan if is_dearer else None)
    legal = [c for c in found if not c.illegal]
    close = [c for c in legal if c.milliseconds <= CLOSE * legal[0].milliseconds][:_MOST_TRIED]
    if len(legal) == 1:
        return Decision(legal[0], tuple(found), speeds, {}, "nothing else is legal")
    if len(close) == 1:
        others = f"the next is predicted to take {legal[1].milliseconds / legal[0].milliseconds:.1f} times as long"
        return Decision(legal[0], tuple(found), speeds, {}, others)
    if renderer is not None:
        times = _piloted(scene, close, renderer, plain, pilot)
        if times:
            tried = [c for c in close if c.name in times]
            best = min(tried, key=lambda c: times[c.name] * (_TO_WIN if c.prepass else 1.0))
            return Decision(best, tuple(found), speeds, times, "the best of a pilot on this device")
    return Decision(legal[0], tuple(found), speeds, {}, "predicted to be the fastest; no pilot was worth it")


def options_of(candidate: Candidate) -> Options:
    """What the compiler is to be asked for."""
    from sdfc.pipeline import Options

    return Options(tracer=candidate.tracer, rays="all" if candidate.all_rays else "cheap", prepass=candidate.prepass)


def _speeds(renderer: GlRenderer) -> Speeds:
    """The device's speeds: measured once, then remembered."""
    from sdfc.glsl.assembly import calibration_shaders
    from sdfc.gpu.calibrate import calibrate

    device = renderer.device
    shaders = calibration_shaders()
    key = repr((device.renderer, device.version, sorted(shaders.items())))
    known = cache.recall("speeds", key)
    if not isinstance(known, dict):
        known = asdict(calibrate(device, shaders))
        cache.remember("speeds", key, known)
    return Speeds(device.renderer, known["frame"], known["addition"], known["row"])


def _piloted(
    scene: Scene, close: Sequence[Candidate], renderer: GlRenderer, plain: Compiled, allowed: bool
) -> dict[str, float]:
    """Milliseconds a small frame for each candidate whose picture is right; nothing where no pilot was allowed."""
    from sdfc.pipeline import compile_scene

    compiled = {c.name: compile_scene(scene, options_of(c)) for c in close}
    texts = [compiled[c.name].glsl("depth") for c in close]
    key = repr(
        (renderer.device.renderer, renderer.device.version, [hashlib.sha256(t.encode()).hexdigest() for t in texts])
    )
    known = cache.recall("pilots", key)
    if isinstance(known, dict):
        return {str(name): float(taken) for name, taken in known.items()}
    if not allowed:
        return {}
    with ExitStack() as stack:
        drawn = {
            name: stack.enter_context(renderer.prepared(Shot(way, View(), {}, PILOT_SIZE), "depth"))
            for name, way in {"": plain, **compiled}.items()
        }
        times = _timed(drawn)
    cache.remember("pilots", key, times)
    return times


def _timed(drawn: dict[str, Prepared]) -> dict[str, float]:
    """The shortest of frames drawn in turn: what else the machine does makes none shorter.

    `drawn[""]` is what the others' hits are held against.
    """
    taken: dict[str, list[float]] = {name: [] for name in drawn}
    for _ in range(1 + _ROUNDS):
        for name, prepared in drawn.items():
            started = time.perf_counter()
            prepared.draw()
            taken[name].append(1e3 * (time.perf_counter() - started))
    hits = {name: prepared.read()[..., 3] > 0.5 for name, prepared in drawn.items()}
    return {
        name: min(times[1:]) for name, times in taken.items() if name and (hits[name] != hits[""]).mean() <= _NO_WORSE
    }
