"""Laws of emitted fields and tracers: they agree with float64, bound the distance, and live beside each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import moderngl
import numpy as np
import pytest
from emitting import IS_FULL, SCENES, prefix_of, program, rendered
from field_truth import agreement, compiled_field, points_near

from sdfc.api.request import View
from sdfc.pipeline import Options

SMALL = [s for s in SCENES if s not in ("city.sdf", "temple.sdf", "chess.sdf", "candle_stand.csg")]
TRACED = SCENES if IS_FULL else ["csg5.sdf", "die.sdf", "blobs.sdf", "spheres.sdf", "gyroid.sdf"]

pytestmark = pytest.mark.gpu


def run(gl: moderngl.Context, text: str, body: str, given: np.ndarray[Any, Any], size: int) -> np.ndarray[Any, Any]:
    """(size, n): what `body` puts into `made`, for the columns `p` (and, of six rows, `d`) of `given`."""
    count, rows = given.shape[1], given.shape[0]
    second = f"vec3 d = vec3(given[{rows}u * i + 3u], given[{rows}u * i + 4u], given[{rows}u * i + 5u]);"
    shader = f"""#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Given {{ float given[]; }};
layout(std430, binding = 1) writeonly buffer Made {{ float made[]; }};
{text}
void main() {{
    uint i = gl_GlobalInvocationID.x, at = {size}u * i;
    if (i >= {count}u) return;
    vec3 p = vec3(given[{rows}u * i], given[{rows}u * i + 1u], given[{rows}u * i + 2u]);
    {second if rows == 6 else ""}
    {body}
}}
"""
    with gl:
        return computed(gl, shader, given, size)


def computed(gl: moderngl.Context, shader: str, given: np.ndarray[Any, Any], size: int) -> np.ndarray[Any, Any]:
    count = given.shape[1]
    compute = gl.compute_shader(shader)
    source = gl.buffer(np.ascontiguousarray(given.T, np.float32).tobytes())
    target = gl.buffer(reserve=4 * size * count)
    source.bind_to_storage_buffer(0)
    target.bind_to_storage_buffer(1)
    compute.run((count + 63) // 64)
    gl.finish()
    made = np.frombuffer(target.read(), np.float32).reshape(count, size).T.astype(np.float64)
    for resource in (source, target, compute):
        resource.release()
    return made


@pytest.fixture(scope="module")
def values(gl_context: moderngl.Context) -> Iterator[dict[str, tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]]]:
    """By scene: points, and distance, gradient and material there. Filled as tests ask."""
    yield {}


def asked(
    scene: str, gl: moderngl.Context, values: dict[str, tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]]
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    if scene not in values:
        x = prefix_of(scene)
        body = f"vec3 g = {x}_gradient(p); made[at] = {x}_sdf(p); made[at + 1u] = g.x; made[at + 2u] = g.y;"
        body += f" made[at + 3u] = g.z; made[at + 4u] = float({x}_material(p));"
        points = points_near(compiled_field(scene), 1)
        values[scene] = points, run(gl, program(scene).glsl("glsl430", part="field", bake=True), body, points, 5)
    return values[scene]


@pytest.mark.parametrize("scene", SCENES if IS_FULL else SMALL)
def test_fields_agree_with_float64(scene: str, gl: moderngl.Context, values: dict[str, Any]) -> None:
    points, made = asked(scene, gl, values)
    assert agreement(compiled_field(scene), points, made[0]) <= 1e-5
    assert ((made[0] > 0.0).mean() > 0.02) and ((made[0] < 0.0).sum() > 5)


@pytest.mark.parametrize("scene", SCENES if IS_FULL else SMALL)
def test_fields_change_no_faster_than_the_distance(scene: str, gl: moderngl.Context, values: dict[str, Any]) -> None:
    """So what a field says is at most the distance: between any two points, and so to any point of the surface."""
    points, made = asked(scene, gl, values)
    size = float(np.ptp(points, axis=1).max())
    for shift in (1, 7, 77, 777):
        apart = np.linalg.norm(points - np.roll(points, shift, axis=1), axis=0)
        assert (np.abs(made[0] - np.roll(made[0], shift)) - apart).max() <= 2e-6 * size


@pytest.mark.parametrize("scene", SCENES if IS_FULL else SMALL)
def test_fields_have_no_jumps(scene: str, gl: moderngl.Context, values: dict[str, Any]) -> None:
    """No faster over short ways either, such as lead across the end of a part's box."""
    points, made = asked(scene, gl, values)
    size = float(np.ptp(points, axis=1).max())
    random = np.random.default_rng(2)
    ways = random.normal(size=points.shape) * 10.0 ** random.uniform(-4.0, -1.0, points.shape[1])
    ends = (points + size * ways).astype(np.float32)
    text = program(scene).glsl("glsl430", part="field", bake=True)
    (there,) = run(gl, text, f"made[at] = {prefix_of(scene)}_sdf(p);", ends, 1)
    apart = np.linalg.norm(ends.astype(np.float64) - points, axis=0)
    assert (np.abs(there - made[0]) - apart).max() <= 2e-6 * size


@pytest.mark.parametrize("scene", ["csg5.sdf", "die.sdf", "spheres.sdf", "bracket.sdf"])
def test_gradients_are_those_of_the_field(scene: str, gl: moderngl.Context, values: dict[str, Any]) -> None:
    """By differences over a short way, where the field is smooth: nearly everywhere."""
    points, made = asked(scene, gl, values)
    text = program(scene).glsl("glsl430", part="field", bake=True)
    step = 1e-3 * float(np.ptp(points, axis=1).max())
    x = prefix_of(scene)
    steps = ", ".join(f"{x}_sdf(p + {step} * vec3({a}))" for a in ("1, 0, 0", "0, 1, 0", "0, 0, 1"))
    back = ", ".join(f"{x}_sdf(p - {step} * vec3({a}))" for a in ("1, 0, 0", "0, 1, 0", "0, 0, 1"))
    body = f"vec3 g = (vec3({steps}) - vec3({back})) / {2 * step};"
    body += " made[at] = g.x; made[at + 1u] = g.y; made[at + 2u] = g.z;"
    measured = run(gl, text, body, points, 3)
    off = np.linalg.norm(measured - made[1:4], axis=0)
    assert np.median(off) < 2e-3
    assert (off < 0.02).mean() > 0.9


@pytest.mark.parametrize("part", ["field", "tracer"])
def test_two_scenes_live_in_one_shader(part: str, gl: moderngl.Context, values: dict[str, Any]) -> None:
    first, second = (program(s).glsl("glsl430", part=part, bake=True) for s in ("csg5.sdf", "die.sdf"))
    points, alone = asked("csg5.sdf", gl, values)
    body = "made[at] = csg5_sdf(p); made[at + 1u] = die_sdf(p); made[at + 2u] = float(die_material(p));"
    both = run(gl, first + second, body, points, 3)
    other = run(gl, second, "made[at] = die_sdf(p);", points, 1)
    assert np.abs(both[0] - alone[0]).max() < 1e-5
    assert np.abs(both[1] - other[0]).max() < 1e-5
    assert len(np.unique(both[2])) > 2


@pytest.mark.parametrize("scene", TRACED)
def test_tracers_find_what_the_renderer_finds(scene: str, gl: moderngl.Context) -> None:
    """In the scene's units: depth, place, normal and material of the rays of a small picture."""
    of, size = program(scene), (48, 27)
    image = rendered(scene, size, tracer="proven", aovs=("depth", "normal", "position", "material"))
    compiled = of.compiled_as(Options(tracer="proven", field=True))
    uniforms = compiled.uniforms(View(), {}, size)
    eye, x, y, ahead = (np.array(uniforms[n]) for n in ("eye", "axis_x", "axis_y", "axis_z"))
    flat = float(np.array(uniforms["pixel"])[2])
    columns, rows = np.meshgrid(
        (np.arange(size[0]) + 0.5) / size[0] * 2 - 1, 1 - (np.arange(size[1]) + 0.5) / size[1] * 2
    )
    across = columns.reshape(1, -1) * x[:, None] + rows.reshape(1, -1) * y[:, None]
    frame = compiled.frame
    origin = (eye[:, None] + (1.0 - flat) * across) * frame.radius + np.array(frame.centre)[:, None]
    direction = ahead[:, None] + flat * across
    text, name = of.glsl("glsl430", part="tracer", bake=True), prefix_of(scene)
    body = f"{name}_hit h = {name}_trace(p, d, 0.0, 1e8); made[at] = h.found ? h.t : -1.0; made[at + 1u] = h.normal.x;"
    body += "made[at + 2u] = h.normal.y; made[at + 3u] = h.normal.z; made[at + 4u] = float(h.material);"
    body += "made[at + 5u] = h.position.x;"
    made = run(gl, text, body, np.concatenate([origin, direction]), 6)
    depth, material = image.depth.reshape(-1), image.aovs["material"].reshape(-1)
    both = np.isfinite(depth) & (made[0] >= 0.0)
    assert (np.isfinite(depth) != (made[0] >= 0.0)).mean() < 0.004, "silhouettes apart, they see the same"
    assert both.sum() > 50
    near = np.abs(made[0] - depth)[both] < 2e-3 * frame.radius
    assert near.mean() > 0.995
    normals = image.normal.reshape(-1, 3).T
    assert (np.linalg.norm(made[1:4] - normals, axis=0)[both] < 0.02).mean() > 0.97
    assert (material == np.round(made[4]))[both].mean() > 0.99
    assert np.abs(made[5] - image.aovs["position"].reshape(-1, 3)[:, 0])[both][near].max() < 4e-3 * frame.radius
