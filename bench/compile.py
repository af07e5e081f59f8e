"""What sdfc itself takes from a scene's text to GLSL, in milliseconds: no driver, no OpenGL.

    python bench/compile.py [SCENE] [--rounds 15]

The scene is bench/fifty.sdf, which has fifty leaves, unless another is named. All is done anew each time, but for
what one process remembers of all scenes (the grammar, the standard library, its GLSL); `edited` also remembers the
searches that the last edit's proofs needed, as `sdfc watch` does. Medians of time, and of time on the CPU, which is
steadier on a machine that others use. `command` is all of `sdfc emit-glsl`, with Python's start and the imports.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import sdfc
from sdfc.field.memory import MEMORY

HERE = Path(__file__).parent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", type=Path, default=HERE / "fifty.sdf")
    parser.add_argument("--rounds", type=int, default=15)
    given = parser.parse_args()
    scene: Path = given.scene
    command = [sys.executable, "-m", "sdfc", "emit-glsl", str(scene)]
    ways: dict[str, Callable[[], object]] = {
        "read": lambda: sdfc.compile(scene),
        "edited": lambda: sdfc.compile(scene).compiled().glsl("radiance"),
        "watch's shader": lambda: sdfc.compile(scene).compiled().glsl("radiance"),
        "full, auto": lambda: sdfc.compile(scene).glsl(),
        "full, proven": lambda: sdfc.compile(scene).glsl(tracer="proven"),
        "full, sphere": lambda: sdfc.compile(scene).glsl(tracer="sphere"),
        "tracer": lambda: sdfc.compile(scene).glsl(part="tracer"),
        "field": lambda: sdfc.compile(scene).glsl(part="field"),
        "command": lambda: subprocess.run(command, check=True, capture_output=True),
    }
    for name, way in ways.items():
        way()  # what is remembered between compilations: the grammar, the standard library, its functions in GLSL
        taken = []
        for _ in range(given.rounds):
            if name != "edited":
                MEMORY.forget()
            taken.append(_timed(way))
        wall, own = (statistics.median(times) for times in zip(*taken, strict=True))
        print(f"{name:16} {wall:7.1f} ms" + (f"  {own:7.1f} ms of CPU" if name != "command" else ""))


def _timed(way: Callable[[], object]) -> tuple[float, float]:
    wall, own = time.perf_counter(), time.process_time()
    way()
    return 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - own)


if __name__ == "__main__":
    main()
