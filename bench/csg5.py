"""Time and error of `proven` against `sphere` on scenes/csg5.sdf: `python bench/csg5.py [ROUNDS]`.

Both in one process, in turn (A B A B ...), medians, 1280x720, frames only (compile and first draw are told apart).
Errors against the closed form in float64. Ratios are what counts: these machines' clocks are not steady.
"""

import statistics
import sys
import time
from pathlib import Path

import numpy as np

from sdfc import pipeline
from sdfc.api import View
from sdfc.api.source import from_path
from sdfc.gpu.device import open_device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram

SIZE = (1280, 720)
SCENE = Path(__file__).parent.parent / "scenes" / "csg5.sdf"


def residual(p: np.ndarray) -> np.ndarray:
    """The scene's value at points (n, 3), in float64."""
    q = np.abs(p) - 0.8
    box = np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)
    ball = np.linalg.norm(p, axis=1) - 1.05
    walls = [np.hypot(p[:, (a + 1) % 3], p[:, (a + 2) % 3]) - 0.5 for a in range(3)]
    return np.maximum.reduce([box, ball, *(-w for w in walls)])


def main(rounds: int) -> None:
    device = open_device()
    given = from_path(SCENE)
    scene = pipeline.load(given.source, given.folder, given.kind)
    print(f"{device.renderer}; {SIZE[0]}x{SIZE[1]}; medians of {rounds}")
    for entry, attachments in (("depth", 1), ("radiance", 1)):
        programs, times = {}, {"proven": [], "sphere": []}
        for tracer in times:
            compiled = pipeline.compile_scene(scene, pipeline.Options(tracer=tracer))
            program = FragmentProgram(device, compiled.glsl(entry), compiled.vertex())
            programs[tracer] = program, compiled.uniforms(View(), {}, SIZE)
        with Frame(device, *SIZE, attachments) as frame:
            for tracer, (program, uniforms) in programs.items():
                start = time.perf_counter()
                frame.draw(program, uniforms)
                first = 1e3 * (time.perf_counter() - start)
                image = frame.read(0)
                print(f"{entry:9} {tracer:7} first draw {first:6.1f} ms, hits {(image[..., 3] > 0.5).sum()}", end="")
                print(f", steps {image[..., 1].mean():.2f} a pixel" if entry == "depth" else "")
            for _ in range(rounds):
                for tracer, (program, uniforms) in programs.items():
                    program.set(uniforms)
                    with frame._in_use():
                        device.context.finish()
                        start = time.perf_counter()
                        program.draw()
                        device.context.finish()
                        times[tracer].append(1e3 * (time.perf_counter() - start))
        middle = {tracer: statistics.median(taken) for tracer, taken in times.items()}
        print(f"{entry:9} " + ", ".join(f"{t} {m:.2f} ms" for t, m in middle.items()), end="")
        print(f": sphere / proven = {middle['sphere'] / middle['proven']:.2f}")
    compiled = pipeline.compile_scene(scene)
    program = FragmentProgram(device, compiled.glsl("probe"), compiled.vertex())
    with Frame(device, *SIZE, 4) as frame:
        frame.draw(program, compiled.uniforms(View(), {}, SIZE))
        hit = frame.read(0)[..., 3] > 0.5
        error = np.abs(residual(frame.read(2)[..., :3][hit].astype(np.float64)))
    print(f"proven: residual max {error.max():.2e}, median {np.median(error):.2e}, of {hit.sum()} hits")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 15)
