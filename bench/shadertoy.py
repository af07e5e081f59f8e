"""Our emitted tracers for Shadertoy beside ones written by hand (bench/foreign/NAME_toy.glsl), in one GL context.

    python bench/shadertoy.py [NAME ...] [--size 640x360] [--rounds 15]

All are wrapped in one and the same main: a ray from the scene's camera, and out come the first hit's normal and
distance. They take turns; times are medians, ours as a share of the hand-written one's. Beside them: how many rays of
the picture hit where truth does not, or the other way round, and how far off the depths are (in millionths of the
scene's size, the median and all but a hundredth), both against `sdfc render --tracer proven`.

`sphere` is the emitted sphere tracer, asked for as much as the hand-written one: a hit is where the distance is below
0.0002 of the way; `sphere, fine` for all that float32 has; `proven` is what emit-glsl gives where nobody asks for a
tracer.
"""

from __future__ import annotations

import argparse
import statistics
import struct
import time
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

import sdfc
from sdfc.api.request import View

NAMES = ("csg5", "die")
HERE = Path(__file__).parent
_WARM_UP = 3  # rounds that do not count
_FRAMES = 4  # between two looks at the clock
_EPSILON = 0.0002  # of the hand-written loop
_FINE = 0.015625  # our tolerance is this share of half a pixel

_VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0); }
"""
_MAIN = """
uniform vec3 eye, axis_x, axis_y, axis_z;
layout(location = 0) out vec4 seen;
void main() {
    vec2 at = 2.0 * gl_FragCoord.xy / resolution - 1.0;
    vec3 direction = normalize(axis_z + at.x * axis_x + at.y * axis_y);
    HIT
}
"""
_HEAD = "#version 330 core\nuniform vec2 resolution;\n#define iResolution vec3(resolution, 1.0)\n"
_OURS = "{x}_hit h = {x}_trace_pixel(eye, direction, 0.0, 100.0, vec2(0.0, {growth})); "
_OURS += "seen = h.found ? vec4(h.normal, h.t) : vec4(-1.0);"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=NAMES, metavar="NAME")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--rounds", type=int, default=15)
    given = parser.parse_args()
    width, height = (int(side) for side in given.size.split("x"))
    for name in given.names:
        measure(name, (width, height), given.rounds)


def measure(name: str, size: tuple[int, int], rounds: int) -> None:
    """Print the medians of one scene."""
    program = sdfc.compile(HERE.parent / "scenes" / f"{name}.sdf")
    with program:
        truth = program.render(size, tracer="proven", aovs=("depth",), backend="gl").depth
    gl = moderngl.create_standalone_context(backend="egl")
    frame = gl.framebuffer([gl.texture(size, 4, dtype="f4")])
    drawn = {who: _program(gl, text, _camera(program, size)) for who, text in _texts(name, program).items()}
    taken: dict[str, list[float]] = {who: [] for who in drawn}
    for turn in range(_WARM_UP + rounds):
        for who, array in drawn.items():
            frame.use()
            gl.finish()
            began = time.perf_counter()
            for _ in range(_FRAMES):
                array.render(moderngl.TRIANGLES, vertices=3)
            gl.finish()
            if turn >= _WARM_UP:
                taken[who].append(1e3 * (time.perf_counter() - began) / _FRAMES)
    base = statistics.median(taken["by hand"])
    print(f"{name} at {size[0]}x{size[1]}, {gl.info['GL_RENDERER']}")
    for who, array in drawn.items():
        frame.use()
        array.render(moderngl.TRIANGLES, vertices=3)
        made = np.frombuffer(frame.read(components=4, dtype="f4"), np.float32).reshape(size[1], size[0], 4)[::-1, :, 3]
        took = statistics.median(taken[who])
        print(f"  {who:14} {took:8.2f} ms  {took / base:5.2f}  {_error(made, truth, program)}")
    gl.release()


def _texts(name: str, program: sdfc.Program) -> dict[str, str]:
    """Whole fragment shaders, by who wrote them."""
    by_hand = (HERE / "foreign" / f"{name}_toy.glsl").read_text()
    made = {"by hand": _HEAD + by_hand + _MAIN.replace("HIT", "seen = march(eye, direction);")}
    for who, tracer, growth in (
        ("sphere", "sphere", _EPSILON / _FINE),
        ("sphere, fine", "sphere", 0.0),
        ("proven", "proven", 0.0),
    ):
        text = program.glsl("shadertoy", part="tracer", tracer=tracer, prefix=name)
        made[who] = _HEAD + text + _MAIN.replace("HIT", _OURS.format(x=name, growth=growth))
    return made


def _camera(program: sdfc.Program, size: tuple[int, int]) -> dict[str, Any]:
    """The rays of `sdfc render`, in the scene's units."""
    compiled = program.compiled("proven")
    uniforms, frame = compiled.uniforms(View(), {}, size), compiled.frame
    eye = np.array(uniforms["eye"]) * frame.radius + np.array(frame.centre)
    return {"eye": tuple(eye), "resolution": size} | {n: uniforms[n] for n in ("axis_x", "axis_y", "axis_z")}


def _program(gl: moderngl.Context, text: str, uniforms: dict[str, Any]) -> moderngl.VertexArray:
    made = gl.program(vertex_shader=_VERTEX, fragment_shader=text)
    for name, value in uniforms.items():
        made[name].write(struct.pack(f"{len(value)}f", *value))
    return gl.vertex_array(made, [])


def _error(made: np.ndarray[Any, Any], truth: np.ndarray[Any, Any], program: sdfc.Program) -> str:
    hit, expected = made >= 0.0, np.isfinite(truth)
    both = hit & expected
    size = 2.0 * program.compiled("proven").frame.radius
    off = np.abs(made[both] - truth[both]) / size * 1e6
    middle, most = np.quantile(off, (0.5, 0.99))
    missed, false = int((expected & ~hit).sum()), int((hit & ~expected).sum())
    return f"missed {missed}, false {false}, off by {middle:.2f} ({most:.1f}) millionths"


if __name__ == "__main__":
    main()
