"""From an edit to its picture, in milliseconds: numbers only, beside a compile, beside one that a worker made ahead.

    python bench/edits.py [SCENE ...] [--size 640x360] [--rounds 9]

One number of each scene is edited, differently each time, in three ways that take turns, in one process:

numbers  as `sdfc watch` does it from the second edit on: the number is a uniform;
anew     with all numbers baked: sdfc's own work (compiling: text to GLSL), then the driver's and the picture (drawing);
ahead    as anew, but a worker process compiles the shader first (its time apart, with how many pictures of `numbers`
         were drawn meanwhile, and how long each took); then this process draws.

Medians. The driver's cache is a new, empty folder, so that no shader was ever seen. A picture is written as PNG. The
number of each line that says `spin` is a loop of Python that does nothing: what the machine was worth at the time.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sdfc.live.snapshot import Snapshot

SCENES = ("csg5", "die", "blobs", "city", "column")
HERE = Path(__file__).parent
_NUMBER = re.compile(r"[0-9]+(\.[0-9]+)?|\.[0-9]+")
_WARM_UP = 2  # rounds that do not count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args()
    width, height = (int(side) for side in given.size.split("x"))
    scenes = given.scenes or [HERE.parent / "scenes" / f"{name}.sdf" for name in SCENES]
    with tempfile.TemporaryDirectory() as folder:
        os.environ["MESA_SHADER_CACHE_DIR"] = folder  # before any OpenGL
        for scene in scenes:
            measure(scene, (width, height), given.rounds, Path(folder))


def measure(scene: Path, size: tuple[int, int], rounds: int, folder: Path) -> None:
    """Print the medians of one scene."""
    bench = Bench(scene, size, folder)
    try:
        taken: dict[str, list[float]] = {}
        for count in range(_WARM_UP + rounds):
            now = bench.round(count)
            if count >= _WARM_UP:
                for what, times in now.items():
                    taken.setdefault(what, []).extend(times)
    finally:
        bench.close()
    of = {what: statistics.median(times) for what, times in taken.items() if times}
    parts = ", ".join(f"{what} {of[what]:.1f}" for what in ("reading", "drawing", "writing"))
    print(f"{scene.stem:9s} numbers {of['numbers']:.1f} ({parts}); spin {of['spin']:.1f}")
    parts = ", ".join(f"{what} {of['anew ' + what]:.0f}" for what in ("compiling", "drawing", "writing"))
    print(f"{'':9s} anew {of['anew']:.0f} ({parts}), x{of['anew'] / of['numbers']:.1f}")
    pictures = f"{len(taken['meanwhile']) / rounds:.1f} pictures, {of.get('meanwhile', 0.0):.0f} each"
    print(
        f"{'':9s} ahead: the worker {of['worker']:.0f} ({pictures}), then drawing {of['ahead drawing']:.0f}", flush=True
    )


class Bench:
    """One scene, and the three ways to follow it."""

    def __init__(self, scene: Path, size: tuple[int, int], folder: Path) -> None:
        from sdfc.live.session import Session
        from sdfc.live.worker import Worker

        self.size = size
        self.text = scene.read_text()
        self.worker = Worker(print)
        copied = shutil.copytree(scene.parent, folder / "scenes", dirs_exist_ok=True)  # its imports and tables too
        self.place = copied / scene.name
        self.numbers = Session(folder / "numbers.png", size, "auto", "gl", print)
        self.anew = Session(folder / "anew.png", size, "auto", "gl", print)
        try:
            self.start = self._live_literal()
        except BaseException:
            self.close()
            raise

    def _live_literal(self) -> int:
        """Where the first number stands that becomes a uniform when it is edited."""
        from sdfc.live.text import read
        from sdfc.live.update import Speed

        for literal in read(self.text).literals:
            if literal.unit != "color" and literal.value[0]:
                self.numbers.distrust()
                speeds = [self.numbers.update(self._edited(literal.start, f)).speed for f in (1.0, 1.001, 1.002)]
                if speeds[1:] == [Speed.NEW_SHADER, Speed.NUMBERS]:
                    return literal.start
        raise SystemExit(f"no number of {self.place} becomes live")

    def _edited(self, start: int, factor: float) -> Snapshot:
        """A snapshot of the scene with the number there times `factor`."""
        from sdfc.live.snapshot import take

        match = _NUMBER.match(self.text, start)
        assert match is not None
        self.place.write_text(self.text[:start] + f"{float(match[0]) * factor:.7f}" + self.text[match.end() :])
        return take(self.place)

    def round(self, count: int) -> dict[str, list[float]]:
        """One edit in each way, in milliseconds by what took them; the order changes from round to round."""
        ways = [self._numbers, self._anew, self._ahead]
        found: dict[str, list[float]] = {"spin": [_spin()]}
        for turn in range(3):
            way = (count + turn) % 3
            for what, took in ways[way](1.01 + 1e-4 * (4 * count + way)):
                found.setdefault(what, []).append(took)
        found.setdefault("meanwhile", [])
        return found

    def _numbers(self, factor: float) -> Iterator[tuple[str, float]]:
        update = self.numbers.update(self._edited(self.start, factor))
        yield "numbers", update.milliseconds
        yield from update.times.items()

    def _anew(self, factor: float) -> Iterator[tuple[str, float]]:
        snapshot = self._edited(self.start, factor)
        self.anew.distrust()
        update = self.anew.update(snapshot)
        yield "anew", update.milliseconds
        yield from ((f"anew {what}", took) for what, took in update.times.items())

    def _ahead(self, factor: float) -> Iterator[tuple[str, float]]:
        from sdfc.api.renderer import Shot
        from sdfc.api.request import View
        from sdfc.live.build import ENTRY, build
        from sdfc.live.worker import Outcome, job_of
        from sdfc.pipeline import Options

        renderer = self.anew.renderer
        built = build(self._edited(self.start, factor), Options(rays=renderer.rays), {}, [], None)
        params = {param.name: param.default for param in built.compiled.scene.params}
        shot = Shot(built.compiled, View(), params, self.size)
        job = job_of(shot, ENTRY)
        started = time.perf_counter()
        future = self.worker.compile(job)
        done: list[float] = []
        future.add_done_callback(lambda _: done.append(1e3 * (time.perf_counter() - started)))
        pictures = 0
        while not done:
            pictures += 1
            yield "meanwhile", next(self._numbers(factor + 1e-5 * (pictures % 9)))[1]
        assert future.result() is Outcome.KEPT
        yield "worker", done[0]
        started = time.perf_counter()
        renderer.radiance(shot, 0, None)
        yield "ahead drawing", 1e3 * (time.perf_counter() - started)

    def close(self) -> None:
        """End the worker, give the devices back."""
        self.worker.close()
        self.numbers.close()
        self.anew.close()


def _spin() -> float:
    started = time.perf_counter()
    for _ in range(200_000):
        pass
    return 1e3 * (time.perf_counter() - started)


if __name__ == "__main__":
    main()
