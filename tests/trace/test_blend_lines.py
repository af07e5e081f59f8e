"""Law: a blend is above its level all the way that the lines below its operands say is clear, whatever its kernel."""

from __future__ import annotations

import re

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray
from truth import Tracing, certified, compiled_text, footprint, tolerance, verdict, wrong

from sdfc.api.request import View

pytestmark = pytest.mark.gpu

Array = NDArray[np.float64]

KERNELS = ("quadratic", "cubic", "circular", "exponential", "root", "round")
SAMPLES = 64
COUNT = 20_000
BALLS = [f"sphere(radius: 0.3).translate([{0.5 * i}, 0, 0])" for i in range(3)]

_MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Given {{ float given[]; }};
layout(std430, binding = 1) writeonly buffer Made {{ float made[]; }};
void main() {{
    uint i = gl_GlobalInvocationID.x, n = {count}u;
    if (i >= n) return;
    prepare();
    float level = given[i], value = {name}_ahead(0.0, {lines});
    float clear = {name}_clear(value, level, {lines});
    made[i] = value;
    made[n + i] = clear;
    for (int k = 0; k < {samples}; k++) {{
        float share = float(k + 1) / float({samples});
        made[uint(2 + k) * n + i] = {name}_ahead(share * clear, {lines});
    }}
    made[{beyond}u * n + i] = {name}_ahead(1.02 * clear + 1e-5, {lines});
}}
"""


def ahead(gl: moderngl.Context, text: str, level: Array, lines: Array) -> tuple[Array, Array, Array, Array]:
    """Values now (n,), what is clear, values on the way there (SAMPLES, n), and just beyond.

    `lines` (operands, 2, n): each operand's value and its slope.
    """
    compiled = compiled_text(text)
    head, _, _ = compiled.glsl("depth").partition("layout(location = 0) out vec4 first_out")
    head = re.sub(r"^(noperspective|flat) in .*$", "", head, flags=re.MULTILINE)
    head = re.sub(r"^void camera_ray\(.*?^}$", "", head, flags=re.MULTILINE | re.DOTALL)
    (name,) = re.findall(r"^float (\w+)_clear\(", head, flags=re.MULTILINE)
    count = level.size
    given = [f"vec2(given[{2 * k + 1}u * n + i], given[{2 * k + 2}u * n + i])" for k in range(len(lines))]
    main = _MAIN.format(count=count, name=name, lines=", ".join(given), samples=SAMPLES, beyond=2 + SAMPLES)
    program = gl.compute_shader(head + main)
    rows = np.concatenate([level[None], lines.reshape(-1, count)]).astype(np.float32)
    source, target = gl.buffer(np.ascontiguousarray(rows).tobytes()), gl.buffer(reserve=4 * (3 + SAMPLES) * count)
    source.bind_to_storage_buffer(0)
    target.bind_to_storage_buffer(1)
    program.run((count + 63) // 64)
    gl.finish()
    made = np.frombuffer(target.read(), np.float32).reshape(3 + SAMPLES, count).astype(np.float64)
    for resource in (program, source, target):
        resource.release()
    return made[0], made[1], made[2:-1], made[-1]


def scene(kernel: str, width: float, nested: bool) -> str:
    two = f"union(blend: {width}, kernel: {kernel}) {{ {BALLS[0]} {BALLS[1]} }}"
    whole = f"union(blend: {width}, kernel: {kernel}) {{ {two} {BALLS[2]} }}" if nested else two
    return f"scene {{ {whole} }}"


@pytest.mark.parametrize("is_nested", [False, True], ids=["two", "nested"])
@pytest.mark.parametrize("kernel", KERNELS)
def test_what_is_clear_is_clear(kernel: str, is_nested: bool, gl: moderngl.Context) -> None:
    random = np.random.default_rng(3)
    operands = 3 if is_nested else 2
    for width in (0.01, 0.3):
        first = 10.0 ** random.uniform(-4, 1, COUNT)
        values = first * 10.0 ** random.normal(0.0, 0.6, (operands, COUNT))
        slopes = random.uniform(-1, 1, (operands, COUNT))
        level = random.choice([1e-6, -4e-6], COUNT)  # by itself, and sunk in an intersection
        lines = np.stack([values, slopes], axis=1)
        value, clear, on_the_way, beyond = ahead(gl, scene(kernel, width, is_nested), level, lines)
        above = value > 2e-5
        assert above.mean() > 0.3
        size = np.maximum(1.0, values.max(axis=0) + clear)
        depth = ((level - on_the_way).max(axis=0) / size)[above]
        assert depth.max() < 4e-6, f"{(depth > 4e-6).sum()} of {depth.size} pass below the level, by {depth.max():.1e}"
        ends = (slopes < -1e-3).any(axis=0) & above  # there is a root; most steps come to it
        assert (beyond < level + 0.02 * value)[ends].mean() > 0.9


@pytest.mark.parametrize("floor", ["plane(offset: -0.3)", "plane(normal: [0.2, 1, 0.1], offset: -0.3)"])
def test_above_a_blended_floor_a_ray_is_clear_in_a_few_steps(floor: str, tracing: Tracing) -> None:
    """No operand's line falls: however far, there is nothing."""
    compiled = compiled_text(f"scene {{ union(blend: 0.4) {{ {floor} sphere(radius: 0.6) }} }}")
    view = View(eye=(0.3, 1.2, 4.0), target=(0.2, 1.22, 3.0), up=(0.0, 1.0, 0.0), fov=0.5)
    picture = tracing.picture(compiled, (64, 37), view)
    assert not picture.unfinished.any()
    assert picture.steps.max() < 100


@pytest.mark.parametrize("width", [0.01, 0.1])
@pytest.mark.parametrize("solid", ["{two}", "difference({operands}, blend: {k}, kernel: round)"])
def test_round_blends_are_traced_as_proved(solid: str, width: float, tracing: Tracing) -> None:
    operands = "box(size: [1, 0.5, 0.6]), sphere(radius: 0.4).translate([0.2, 0.3, 0.1])"
    two = f"union({operands}, blend: {width}, kernel: round)"
    compiled = compiled_text(f"scene {{ {solid.format(two=two, operands=operands, k=width)} }}")
    size, view = (64, 36), View(eye=(1.6, 1.2, 2.0), target=(0.0, 0.1, 0.0), up=(0.0, 1.0, 0.0), fov=0.5)
    picture = tracing.picture(compiled, size, view, {}, 2000.0)
    cone = tuple(c / 2000.0 for c in footprint(compiled, size, view))
    truth = certified(compiled, picture, tolerance(compiled, picture, (cone[0], cone[1])))
    result = verdict(compiled, picture, truth, (cone[0], cone[1]))
    assert result.correct and not wrong(picture, truth).size, str(result)
