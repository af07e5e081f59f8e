"""A run: scene after scene; every cell is kept as soon as it is known."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sdfc import pipeline
from sdfc.api.renderer import GlRenderer
from sdfc.api.source import from_path
from sdfc.diagnostics import InternalError
from sdfc.measure.bench import heat, machine, store
from sdfc.measure.bench.competition import Competition
from sdfc.measure.bench.entrants import plan
from sdfc.measure.bench.plan import Wanted
from sdfc.measure.bench.record import Cell, Record
from sdfc.measure.bench.store import Store
from sdfc.scene.model import Scene

Progress = Callable[[int, int, str], None]  # cells done, cells in all, the last one
Note = Callable[[str], None]


@contextmanager
def uncached() -> Iterator[None]:
    """Keeps Mesa from remembering programs, if this is the process's first device: else no compile time were one."""
    before = os.environ.get("MESA_SHADER_CACHE_DISABLE")
    os.environ["MESA_SHADER_CACHE_DISABLE"] = "true"
    try:
        yield
    finally:
        if before is None:
            del os.environ["MESA_SHADER_CACHE_DISABLE"]
        else:
            os.environ["MESA_SHADER_CACHE_DISABLE"] = before


@contextmanager
def opened() -> Iterator[GlRenderer]:
    """A device of its own: the programs that it compiled go with it."""
    with uncached():
        renderer = GlRenderer()
    try:
        yield renderer
    finally:
        renderer.close()


def bench(wanted: Wanted, folder: Path | None, progress: Progress, note: Note) -> Store:
    """Measure what is wanted and not in the folder yet. Raises SceneError, RequestError, DeviceError.

    Where sdfc itself fails on a scene (two proofs that disagree, a shader refused), `failures` says so, and the others
    are measured.
    """
    with opened() as renderer:
        kept = store.opened(folder, machine.described(renderer.device), wanted.settings)
    kept.save()
    done = 0

    def finished(cell: Cell, record: Record | None) -> None:
        nonlocal done
        done += 1
        if record is not None:
            kept.add(record)
        progress(done, wanted.cells, str(cell))

    scenes = {path: _loaded(path) for path in wanted.scenes}  # what is wrong with one is said before all is measured
    for path, scene in scenes.items():
        planned = None
        for size in wanted.sizes_of(path.name):
            try:
                if planned is None and wanted.has_choice(path.name):
                    with opened() as renderer:
                        planned = plan(scene, renderer)
                with opened() as renderer:
                    competition = Competition(wanted, path.name, scene, size, renderer, kept, planned)
                    competition.hold(finished)
                    if folder is not None:
                        heat.draw(competition, folder, note)
            except InternalError as error:  # a bug of ours must not cost the other scenes' hour
                kept.failures.append(f"{path.name}: {error}")
                note(kept.failures[-1])
    return kept


def _loaded(path: Path) -> Scene:
    given = from_path(path)
    return pipeline.load(given.source, given.folder, given.kind)
