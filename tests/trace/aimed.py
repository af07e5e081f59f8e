"""Any rays through a tracer's own GLSL: not a camera's, but chosen ones, with their start and their end."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TypeAlias

import moderngl
import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.diagnostics import Source
from sdfc.pipeline import Compiled, Options

Array: TypeAlias = NDArray[np.float64]

LOOKS = 64  # so many looks of a ray are told

_LOOKED = "float looked(float at, float v) { looks[min(int(steps), LOOKS - 1)] = at; return v; }"

_MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Given { float given[]; };
layout(std430, binding = 1) writeonly buffer Made { float made[]; };
void main() {
    uint i = gl_GlobalInvocationID.x, n = COUNTu;
    if (i >= n) return;
    prepare();
    vec3 o = vec3(given[i], given[n + i], given[2u * n + i]);
    vec3 d = vec3(given[3u * n + i], given[4u * n + i], given[5u * n + i]);
    travelled = given[8u * n + i];
    cone = vec2(given[9u * n + i], given[10u * n + i]);
    made[i] = trace(o, d, given[6u * n + i], given[7u * n + i]);
    made[n + i] = evaluations;
    made[2u * n + i] = unfinished;
    for (int k = 0; k < LOOKS; k++) made[uint(3 + k) * n + i] = looks[k];
}
"""


@dataclass(frozen=True, slots=True)
class Aimed:
    """What a tracer said of n rays: `t` (1e9: nothing hit), `looks` (LOOKS, n) where it looked, NaN after the last."""

    t: Array
    evaluations: Array
    unfinished: NDArray[np.bool_]
    looks: Array

    @property
    def hit(self) -> NDArray[np.bool_]:
        return self.t < 1e8


def compiled(text: str, tracer: str, most_steps: int | None = None) -> Compiled:
    """A scene's text, for a tracer that takes at most so many passes."""
    scene = pipeline.load(Source("test.sdf", text), None)
    return pipeline.compile_scene(scene, Options(tracer, most_steps=most_steps))


def shader(scene: Compiled, count: int) -> str:
    """The scene's depth shader, but with rays from a buffer."""
    text = scene.glsl("depth").replace("\r", "")
    head, _, _ = text.partition("layout(location = 0) out vec4 first_out")
    head = re.sub(r"^(noperspective|flat) in .*$", "", head, flags=re.MULTILINE)
    head = re.sub(r"^void camera_ray\(.*?^}$", "", head, flags=re.MULTILINE | re.DOTALL)
    head = head.replace("float steps = 0.0;", f"float looks[{LOOKS}];\nfloat steps = 0.0;")
    head = head.replace("float trace(", f"{_LOOKED.replace('LOOKS', str(LOOKS))}\nfloat trace(")
    head = re.sub(r"(?<=[= ])map\(o \+ (\w+) \* d\)", r"looked(\1, map(o + \1 * d))", head)
    main = _MAIN.replace("COUNT", str(count)).replace("LOOKS", str(LOOKS))
    return f"{head}{main}"


def aim(
    gl: moderngl.Context,
    scene: Compiled,
    o: Array,
    d: Array,
    start: float | Array = 0.0,
    limit: float | Array = 1e9,
    *,
    travelled: float | Array = 0.0,
    cone: tuple[float, float] = (0.0, 1e-3),
) -> Aimed:
    """Traces rays (3, n) in the scene's own coordinates. `cone`: half a pixel at the eye, and its growth."""
    count = o.shape[1]
    numbers = (start, limit, travelled, *cone)
    rows = [*o, *d, *(np.broadcast_to(np.asarray(v, float), (count,)) for v in numbers)]
    program = gl.compute_shader(shader(scene, count))
    source = gl.buffer(np.ascontiguousarray(np.stack(rows).astype(np.float32)).tobytes())
    target = gl.buffer(reserve=4 * (3 + LOOKS) * count)
    source.bind_to_storage_buffer(0)
    target.bind_to_storage_buffer(1)
    program.run((count + 63) // 64)
    gl.finish()
    made = np.frombuffer(target.read(), np.float32).reshape(3 + LOOKS, count).astype(np.float64)
    for resource in (program, source, target):
        resource.release()
    beyond = np.arange(LOOKS)[:, None] >= made[1] - 0.5
    return Aimed(made[0], made[1], made[2] > 0.5, np.where(beyond, np.nan, made[3:]))


def own(scene: Compiled, o: Array, d: Array) -> tuple[Array, Array]:
    """Rays of the scene's coordinates in its own: lengths along them are divided by its radius."""
    frame = scene.frame
    origin = (o - np.array(frame.centre)[:, None]) / frame.radius
    return origin, np.broadcast_to(d / np.linalg.norm(d, axis=0), o.shape)
