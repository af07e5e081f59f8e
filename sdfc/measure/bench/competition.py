"""One scene at one size: its competitors, timed in turn, group by group, and judged by its truth."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import assert_never

import numpy as np

from sdfc import pipeline
from sdfc.api.renderer import GlRenderer
from sdfc.api.request import View
from sdfc.measure.bench import contest
from sdfc.measure.bench.answers import Answers, Array, RayDrawing, Size, covered
from sdfc.measure.bench.entrants import Drawing, Entrant, Floor, Illegal, Planned, Reply, Traced, entrant
from sdfc.measure.bench.foreign import Foreign, foreign
from sdfc.measure.bench.judged import Court, court
from sdfc.measure.bench.machine import now
from sdfc.measure.bench.plan import FLOOR, FOREIGN, Group, Wanted
from sdfc.measure.bench.record import Cell, Errors, Record
from sdfc.measure.bench.store import Store
from sdfc.pipeline import Compiled, Options
from sdfc.scene.model import Scene

MEANING = 1  # of the numbers: raised where they mean something else than before, so that old cells are measured anew

Finished = Callable[[Cell, Record | None], None]  # a cell, and its record where it was made just now
Legal = Traced | Foreign | Floor


@dataclass(slots=True)
class Competition:
    """See above. Programs and courts are made when they are first needed, and kept."""

    wanted: Wanted
    name: str
    scene: Scene
    size: Size
    renderer: GlRenderer
    kept: Store
    planned: Planned | None = None
    _competitors: dict[tuple[str, int | None], Legal | Illegal] = field(default_factory=dict)
    _starts: dict[str, contest.Start] = field(default_factory=dict)
    _courts: dict[str, Court] = field(default_factory=dict)
    _base: Compiled | None = None

    def hold(self, finished: Finished) -> None:
        """Measure every cell that is not kept yet."""
        for group in self.wanted.groups(self.name, self.size):
            due: dict[str, Legal] = {}
            for name in group.names:
                match self.competitor(name, group.budget):
                    case Illegal(reason=reason):
                        self._illegal(group, name, reason, finished)
                    case legal:
                        if self.kept.kept(group.cell(name), self._key(group, legal.text)) is None:
                            due[name] = legal
                        else:
                            finished(group.cell(name), None)
            if due:
                self._measure(group, due, finished)

    def competitor(self, name: str, budget: int | None = None) -> Legal | Illegal:
        """Of that name."""
        if (name, budget) not in self._competitors:
            self._competitors[name, budget] = self._made(name, budget)
        return self._competitors[name, budget]

    @property
    def base(self) -> Compiled:
        """The scene by any tracer that may trace it: its truth, its rays, its units. Raises SceneError."""
        if self._base is None:
            found = (self.competitor(name) for name in self.wanted.tracers)
            legal = [c.compiled for c in found if isinstance(c, Traced)]
            self._base = legal[0] if legal else pipeline.compile_scene(self.scene, Options())
        return self._base

    def _made(self, name: str, budget: int | None) -> Legal | Illegal:
        kind, _, file = name.partition(":")
        if name == FLOOR:
            return Floor(self.base, self.renderer.device)
        if kind == FOREIGN:
            path = next(p for p in self.wanted.foreign if p.name == file)
            return foreign(name, path, self.base, self.renderer.device)
        return entrant(self.scene, name, budget, self.renderer, self.planned)

    def _key(self, group: Group, text: str) -> str:
        """A hash of all that a cell's numbers depend on."""
        seen = self.base.uniforms(View(), {}, self.size)
        truth, device = self.wanted.settings["truth"], self.renderer.name
        parts = (MEANING, text, sorted(seen.items()), self.size, group.tolerance, truth, device)
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:20]

    def _illegal(self, group: Group, name: str, reason: str, finished: Finished) -> None:
        cell, key = group.cell(name), hashlib.sha256(reason.encode()).hexdigest()[:20]
        there = self.kept.kept(cell, key) is not None
        made = Record(cell, key, now(), self.kept.machine["commit"], illegal=reason)
        finished(cell, None if there else made)

    def _measure(self, group: Group, due: Mapping[str, Legal], finished: Finished) -> None:
        """Time them in turn, the reference among them, then judge each. Those of one shader are drawn once for all."""
        reference = self._reference(group)
        with ExitStack() as stack:
            drawings: dict[str, Drawing] = {}
            for legal in (*reference, *due.values()):
                if legal.text not in self._starts:
                    self._starts[legal.text] = contest.started(legal)
                if legal.text not in drawings:
                    drawings[legal.text] = stack.enter_context(legal.drawing(self.size, group.tolerance))
            taken = contest.frame_times(drawings, self.wanted.repeat)
            beside = taken[reference[0].text] if reference else ()
            for name, legal in due.items():
                answers = self._answers(legal, drawings[legal.text])
                record = Record(
                    group.cell(name),
                    self._key(group, legal.text),
                    now(),
                    self.kept.machine["commit"],
                    legal.note,
                    timing=contest.timing(taken[legal.text], beside),
                    building=contest.building(legal, self._starts[legal.text]),
                    work=contest.work(answers) if answers is not None and legal.reply is Reply.DEPTH else None,
                    errors={} if answers is None else self._errors(legal, group, answers),
                )
                finished(record.cell, record)

    def _reference(self, group: Group) -> tuple[Legal, ...]:
        """What all of the group are timed beside, where it is legal."""
        match self.competitor(group.reference, group.budget):
            case Illegal():
                return ()
            case legal:
                return (legal,)

    def _answers(self, legal: Entrant, drawing: Drawing) -> Answers | None:
        """What the last frame says, if it says anything."""
        match legal.reply:
            case Reply.DEPTH:
                return Answers.of(drawing.read(), self.base.plan.radius)
            case Reply.COVER:
                return covered(drawing.read())
            case Reply.NOTHING:
                return None
            case _:
                assert_never(legal.reply)

    def _errors(self, legal: Legal, group: Group, answers: Answers) -> dict[str, Errors]:
        grid, random = self._court("grid"), self._court("random")
        with legal.drawing(grid.size, group.tolerance) as drawing:
            drawing.draw()
            small = self._answers(legal, drawing)
        if small is None or legal.reply is Reply.COVER:
            return {"random": random.cover(answers)} | ({} if small is None else {"grid": grid.cover(small)})
        return {"grid": grid.judge(small, self._normals(legal, group)), "random": random.judge(answers)}

    def _normals(self, legal: Legal, group: Group) -> Array | None:
        """Our own tracers', where all else is as usual: they are computed at the hit, whoever found it."""
        usual = group.budget is None and group.tolerance == self.wanted.tolerances[0]
        if not isinstance(legal, Traced) or not usual or legal.name not in self.wanted.tracers:
            return None
        with legal.drawing(self.wanted.grid, group.tolerance, "probe", 4) as drawing:
            drawing.draw()
            image: Array = drawing.read(1)[..., :3].astype(np.float64)
        return np.moveaxis(image, -1, 0).reshape(3, -1)

    def _court(self, name: str) -> Court:
        if name not in self._courts:
            rays = RayDrawing(self.renderer.device, self.base.vertex())
            made = {"grid": (self.wanted.grid, None), "random": (self.size, self.wanted.random)}
            self._courts[name] = court(self.base, rays, *made[name], self.wanted.most)
        return self._courts[name]
