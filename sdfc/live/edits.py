"""What each edit of a scene needs: nothing, other uniforms, or a new compile. Who shows it is not known here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from sdfc.live import numbers
from sdfc.live.build import Built, Touched, aimed, build, load
from sdfc.live.snapshot import Edit, Snapshot, compare
from sdfc.live.update import Speed, Stopwatch
from sdfc.pipeline import Compiled, Options

_PROGRAMS_KEPT = 4  # the last ones: an edit that is undone needs no compiling


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A snapshot as it is shown: what was compiled for it, and what its uniforms are."""

    built: Built
    speed: Speed
    values: Mapping[str, tuple[float, ...]]  # of params and live literals: those that an edit set since the compile

    @property
    def params(self) -> dict[str, tuple[float, ...]]:
        """The value of every param and of every live literal."""
        return {p.name: p.default for p in self.built.compiled.scene.params} | dict(self.values)


class Edits:
    """Follows one scene through its snapshots. What is not `kept`, since it could not be shown, was never there."""

    def __init__(self, options: Callable[[], Options]) -> None:
        self._options = options  # asked for when something is compiled, and no sooner: it may open a device
        self._recent: dict[str, Compiled] = {}  # by their code, the last one last
        self.shown: Shown | None = None

    @property
    def recent(self) -> list[Compiled]:
        """Those whose shaders are worth keeping."""
        return list(self._recent.values())

    def next(self, snapshot: Snapshot, watch: Stopwatch, waiting: Shown | None = None) -> Shown:
        """The snapshot as it is to be shown. Raises SceneError for what is wrong with it.

        `waiting` is compiled, and not shown yet: what differs from that in numbers needs no other shader.
        """
        known = [shown for shown in (waiting, self.shown) if shown is not None]
        for shown in known:
            edit = compare(shown.built.snapshot, snapshot)
            if _is_quick(shown.built, snapshot, edit):
                return self._adjusted(shown, snapshot, edit, watch)
        return self._rebuilt(known[0].built if known else None, snapshot, watch)

    def _adjusted(self, shown: Shown, snapshot: Snapshot, edit: Edit, watch: Stopwatch) -> Shown:
        """What is compiled already, with other uniforms."""
        before = shown.built
        built = replace(before, snapshot=snapshot, live=_touched_last(before, edit))
        if edit == Edit():
            return Shown(built, Speed.NOTHING, shown.values)
        set_now = {made.name: snapshot.literal(key).value for key in edit.literals if (made := before.bound(key))}
        if edit.camera or (before.compiled.scene.camera is None and built.live):
            built = replace(built, compiled=aimed(built.compiled, load(snapshot, {}), self._options()))
        watch.took("reading")
        return Shown(built, Speed.CAMERA if edit.camera else Speed.NUMBERS, {**shown.values, **set_now})

    def _rebuilt(self, before: Built | None, snapshot: Snapshot, watch: Stopwatch) -> Shown:
        edit = Edit(structure=True) if before is None else compare(before.snapshot, snapshot)
        live, touched = _wanted(before, snapshot, edit) if before is not None else ({}, [])
        same = before if not edit.structure else None
        built = build(snapshot, self._options(), live, touched, same)
        known = self._recent.get(built.code)
        if known is not None:  # where comments differ, a driver would compile for nothing
            built = replace(built, compiled=_in_the_words_of(known, built.compiled))
        watch.took("compiling")
        return Shown(built, Speed.NEW_SHADER if known is None else Speed.SAME_SHADER, {})

    def keep(self, shown: Shown) -> None:
        """It is what is shown now."""
        self.shown = shown
        self._recent.pop(shown.built.code, None)
        self._recent[shown.built.code] = shown.built.compiled
        while len(self._recent) > _PROGRAMS_KEPT:
            del self._recent[next(iter(self._recent))]

    def distrust(self) -> None:
        """What is shown may not be what was read: the next snapshot begins anew."""
        self.shown = None

    def forget(self) -> None:
        """No shader is on a device any more."""
        self._recent = {}


def _wanted(before: Built, snapshot: Snapshot, edit: Edit) -> tuple[numbers.Live, list[Touched]]:
    """The literals to go on being live, and those to become so."""
    if edit.structure:
        return numbers.carried(before.live, before.snapshot, snapshot), []
    live = {key: made for key, made in before.live.items() if numbers.is_within(snapshot.literal(key), made)}
    pairs = {key: (before.snapshot.literal(key), snapshot.literal(key)) for key in edit.literals}
    touched = [
        Touched(key, numbers.ranges(*pair))
        for key, pair in pairs.items()
        if key not in live and key not in before.declared and key not in before.fixed
    ]
    return live, touched


def _is_quick(before: Built, snapshot: Snapshot, edit: Edit) -> bool:
    """Whether what is compiled can show the edit: only uniforms change, and what they may be."""
    if edit.structure:
        return False
    scene = before.compiled.scene
    if edit.camera and (scene.camera is None or not scene.lights):  # without lights, the sun stands behind the camera
        return False
    bound = [(key, before.bound(key)) for key in edit.literals]
    return all(made is not None and numbers.is_within(snapshot.literal(key), made) for key, made in bound)


def _touched_last(before: Built, edit: Edit) -> numbers.Live:
    """The live literals with those that were just edited at the end."""
    moved = {key: made for key, made in before.live.items() if key in edit.literals}
    return {key: made for key, made in before.live.items() if key not in moved} | moved


def _in_the_words_of(known: Compiled, new: Compiled) -> Compiled:
    """The new scene with the texts of shaders that are on the device."""
    return replace(known, scene=new.scene, plan=new.plan, setting=new.setting, shape=new.shape, frame=new.frame)
