"""A snapshot compiled, with as many of the touched literals live as can be."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from sdfc import pipeline
from sdfc.diagnostics import InternalError, SceneError
from sdfc.field.graph import params_of
from sdfc.live import numbers
from sdfc.live.numbers import Live
from sdfc.live.snapshot import Key, Snapshot
from sdfc.passes.own_origin import Frame
from sdfc.pipeline import Compiled, Options
from sdfc.plan.setting import setting_of
from sdfc.scene.literals import NO_LITERALS, LiveLiteral
from sdfc.scene.model import Scene

ENTRY = "radiance"
_BEGINS = frozenset(("param", "def", "field", "material", "camera", "light", "sky", "scene", "import", "in"))
_MOST_GROWTH = 1.5  # times as much GLSL is too much for one live number: a loop over a table came undone
_COMMENT = re.compile(r"\s*//[^\n]*")


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """A compiled snapshot: which literals are live in it, and which of its params are a single literal by default."""

    snapshot: Snapshot
    compiled: Compiled
    live: Live
    declared: Live
    fixed: frozenset[Key]  # what was tried, and cannot be live in this structure
    code: str  # the shader without its comments: what decides whether it is another one

    def bound(self, key: Key) -> LiveLiteral | None:
        """The uniform that the literal is, if it is one."""
        return self.live.get(key) or self.declared.get(key)


@dataclass(frozen=True, slots=True)
class Touched:
    """A literal that was changed, with the ranges to try."""

    key: Key
    ranges: Sequence[tuple[float, float]]


def load(snapshot: Snapshot, live: Live) -> Scene:
    """The scene, with these literals live."""
    given = snapshot.given
    literals = numbers.places(live, snapshot) if live else NO_LITERALS
    return pipeline.load(given.source, given.folder, given.kind, literals)


def build(
    snapshot: Snapshot, options: Options, carried: Live, touched: Sequence[Touched], before: Built | None
) -> Built:
    """The snapshot compiled. Raises SceneError for what is wrong with it.

    A literal stays baked where the scene cannot have it live: where a loop's end or a shape depends on it, where a fact
    does not hold in its range, where there are sixteen already (the one touched longest ago gives way).
    """
    scene = load(snapshot, {})
    room = pipeline.MOST_PARAMS - len(scene.params)
    if any(made.name in content for made in carried.values() for content in snapshot.contents.values()):
        carried = {}
    wanted = list(touched)[-room:] if room > 0 else []
    live = _settled(snapshot, carried, wanted, room)
    largest = _MOST_GROWTH * len(before.code) if before is not None and live.keys() - carried.keys() else math.inf
    fixed = frozenset(item.key for item in wanted) | (before.fixed if before is not None else frozenset())
    for attempt in (live, {key: made for key, made in live.items() if key in carried}):
        if attempt:
            try:
                built = _compiled(snapshot, load(snapshot, attempt), options, attempt, scene)
            except (SceneError, InternalError):  # what is proved of single numbers need not hold for ranges
                continue
            if len(built.code) <= largest:
                return replace(built, fixed=fixed - attempt.keys())
    return replace(_compiled(snapshot, scene, options, {}, scene), fixed=fixed)


def _settled(snapshot: Snapshot, carried: Live, wanted: Sequence[Touched], room: int) -> dict[Key, LiveLiteral]:
    """The literals that elaboration accepts, in the ranges that it accepts them in."""
    fresh = {item.key for item in wanted}
    kept = [(key, made) for key, made in carried.items() if key not in fresh]
    live = dict(kept[max(0, len(kept) - (room - len(wanted))) :])
    if live and not _accepted(snapshot, live):
        live = {}
    free = numbers.names(pipeline.MOST_PARAMS, list(snapshot.contents.values()), live)
    named = [(item, next(free)) for item in wanted]
    whole = live | {item.key: LiveLiteral(name, *item.ranges[0]) for item, name in named if item.ranges}
    if _accepted(snapshot, whole):
        return whole
    for item, name in named:
        for low, high in item.ranges:
            tried = live | {item.key: LiveLiteral(name, low, high)}
            if _accepted(snapshot, tried):
                live = tried
                break
    return live


def _accepted(snapshot: Snapshot, live: Live) -> bool:
    """Whether the scene can be read with these live, and each of them is one: none was left in a claim or an index."""
    try:
        scene = load(snapshot, live)
    except (SceneError, InternalError):
        return False
    names = {made.name for made in live.values()}
    return names <= {param.name for param in scene.params} and not names & _aims(scene)


def _aims(scene: Scene) -> frozenset[str]:
    """The params that the camera depends on."""
    camera = scene.camera
    if camera is None:
        return frozenset()
    height = () if camera.height is None else (camera.height,)
    return params_of([camera.eye, camera.target, camera.up, camera.fov, *height])


def _compiled(snapshot: Snapshot, scene: Scene, options: Options, live: Live, baked: Scene) -> Built:
    compiled = pipeline.compile_scene(scene, options)
    if live:
        compiled = aimed(compiled, baked, options)
        radius = _frame(baked, options).radius
        compiled = replace(compiled, setting=replace(compiled.setting, reach=radius / compiled.frame.radius))
    code = _COMMENT.sub("", compiled.glsl(ENTRY))
    return Built(snapshot, compiled, live, _declared(snapshot, scene), frozenset(), code)


def aimed(compiled: Compiled, baked: Scene, options: Options) -> Compiled:
    """The compiled scene seen as `baked`, the same scene without live literals, is seen: their ranges frame nothing."""
    camera = baked.camera
    if camera is None:
        camera = setting_of(baked, _frame(baked, options)).camera
    return replace(compiled, setting=replace(compiled.setting, camera=camera))


def _frame(scene: Scene, options: Options) -> Frame:
    """The scene's origin and unit."""
    _, workshop = pipeline.normalise(scene, after="own_origin", own_unit=options.own_unit)
    assert workshop.frame is not None
    return workshop.frame


def _declared(snapshot: Snapshot, scene: Scene) -> dict[Key, LiveLiteral]:
    """`param x = LITERAL in …`: to edit that literal is to set the param."""
    aims = frozenset() if scene.lights else _aims(scene)  # the sun stands where it stood when this was compiled
    params = {p.name: p for p in scene.params if p.name not in aims}
    found: dict[Key, LiveLiteral] = {}
    for name, text in snapshot.texts.items():
        for index, literal in enumerate(text.literals):
            word = literal.word
            before, behind = text.words[max(0, word - 3) : word], text.words[word + 1 : word + 2]
            param = params.get(before[1]) if before[::2] == ("param", "=") else None
            if param is None:
                continue
            if literal.unit == "color" == param.unit and (not behind or behind[0] in _BEGINS):
                found[name, index] = LiveLiteral(param.name, 0.0, 1.0)
            elif behind == ("in",) and param.low is not None and param.high is not None:
                found[name, index] = LiveLiteral(param.name, param.low, param.high)
    return found
