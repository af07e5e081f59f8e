"""`map_span`: over any piece of any ray, `map` keeps to its bounds, and so do its chords."""

from __future__ import annotations

from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.diagnostics import Source
from sdfc.glsl.distance import DistanceWriter
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Functions
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.glsl.names import RESERVED
from sdfc.glsl.span import SpanWriter
from sdfc.pipeline import Compiled, Options
from sdfc.shape.look import Looks
from sdfc.shape.lower import FAR, Lowering

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent.parent
LIBRARY = ROOT / "templates" / "lib"
SAMPLES = 17
TEXTS = {
    "union": "scene { box(size: [1, 2, 0.5]) sphere(radius: 0.4).translate([1, 0, 0]) torus().rotate(x: 40deg) }",
    "difference": "scene { (box() - sphere(radius: 0.6).translate([0.3, 0.4, 0.5])) & cylinder(radius: 0.6) }",
    "warped": "scene { box(size: [0.4, 2, 0.4]).twist(100deg) box().bend(50deg).translate([2, 0, 0]) }",
    "rough": "scene { sphere(radius: 0.7).displace(amplitude: 0.1) gyroid(period: 0.4) & box() }",
    "blended": "scene { smooth_union(sphere(), box().translate([1, 0, 0]), blend: 0.4) }",
    "unclaimed": "field wavy() = length(p) - 0.5 + 0.1 * sin(9 * p.x * p.y)\nscene { wavy() & box() }",
    "repeated": "scene { sphere(radius: 0.2).repeat(spacing: [0.6, 0.6, 0.6]) & sphere() }",
    "many": "scene { union(for i in 0..99: sphere(radius: 0.04).translate([0.1 * i, sin(i), cos(i)])) }",
}


def compiled_text(text: str) -> Compiled:
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text), None), Options("sphere"))


def written(compiled: Compiled) -> str:
    """`map` and `map_span` of a scene without params, with all that they call."""
    graph, plan, live = compiled.scene.values, compiled.plan, Live()
    functions = Functions(graph, Lowering(), Looks(Lowering(), plan.materials, plan.materials[0]))
    many = ManyWriter(graph, functions, live, plan.materials, plan.rows_at_once)
    texts = [
        DistanceWriter(graph, functions, live, plan.slopes, many, traced=True).write(plan.root),
        SpanWriter(graph, functions, live, plan.slopes, many).write(plan.root),
    ]
    assert not live.values, "a value that a uniform decides has nowhere to live here"
    library = [(LIBRARY / name).read_text() for name in ("distance.glsl", "span.glsl")]
    constant = f"const float FAR = {literal(FAR)};\n"
    return "\n".join([constant, *library, *(f.text for f in functions.all), *many.tables, *texts])


def run(gl: moderngl.Context, text: str, o: Array, d: Array, s: Array) -> tuple[NDArray[np.float32], Array]:
    """The spans (4, n) of n pieces of rays, and `map` at SAMPLES places along each, (SAMPLES, n)."""
    count = s.size
    rows = np.concatenate([o, d, s[None]]).astype(np.float32)
    program = gl.compute_shader(f"""#version 450
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Given {{ float given[]; }};
layout(std430, binding = 1) writeonly buffer Made {{ float made[]; }};
{text}
void main() {{
    uint i = gl_GlobalInvocationID.x, n = {count}u;
    if (i >= n) return;
    vec3 o = vec3(given[i], given[n + i], given[2u * n + i]);
    vec3 d = vec3(given[3u * n + i], given[4u * n + i], given[5u * n + i]);
    float s = given[6u * n + i];
    vec4 bounds = map_span(o, d, s);
    for (uint k = 0u; k < 4u; k++) made[k * n + i] = bounds[k];
    for (uint k = 0u; k < {SAMPLES}u; k++)
        made[(4u + k) * n + i] = map(o + (s * float(k) / {SAMPLES - 1}.0) * d);
}}
""")
    source, target = gl.buffer(rows.tobytes()), gl.buffer(reserve=4 * (4 + SAMPLES) * count)
    source.bind_to_storage_buffer(0)
    target.bind_to_storage_buffer(1)
    program.run((count + 63) // 64)
    gl.finish()
    made = np.frombuffer(target.read(), np.float32).reshape(4 + SAMPLES, count)
    for resource in (program, source, target):
        resource.release()
    return made[:4], made[4:].astype(np.float64)


def pieces(seed: int, count: int = 20_000) -> tuple[Array, Array, Array]:
    """Pieces of rays in and around the unit ball, of all lengths, some of them along an axis."""
    random = np.random.default_rng(seed)
    o, d = random.uniform(-1.1, 1.1, (3, count)), random.normal(size=(3, count))
    d /= np.linalg.norm(d, axis=0)
    d[:, ::9] = np.eye(3)[random.integers(0, 3, d[:, ::9].shape[1])].T
    return o, d, 10.0 ** random.uniform(-4.0, 0.3, count)


@pytest.mark.gpu
@pytest.mark.parametrize("name", TEXTS)
def test_the_map_keeps_to_its_span(gl: moderngl.Context, name: str) -> None:
    """The value everywhere; the chords from the start downwards, which is what a step goes by, where it is positive.

    Inside a solid, and where one bound gives way to another, `map` may jump: its slope is then no more than a promise
    about the distance.
    """
    o, d, s = pieces(len(name))
    span, values = run(gl, written(compiled_text(TEXTS[name])), o, d, s)
    assert np.isfinite(span).all() and (span[0] <= span[1]).all() and (span[2] <= span[3]).all()
    slack = 4e-6
    assert (values >= span[0] - slack).all() and (values <= span[1] + slack).all()
    tau = np.linspace(0.0, 1.0, SAMPLES)[:, None] * s
    start = values[0]
    clear = start > slack
    safe = tau < np.where(span[2] < 0.0, (start - slack) / np.maximum(-span[2], 1e-9), np.inf)
    assert (values[safe & clear] > 0.0).all()
    smooth = (span[2] > -1.0) & (span[3] < 1.0)
    if name != "many":  # of a table no more is asked than the distance
        assert smooth.mean() > 0.05, "no piece is known any better than a ball knows it"
    assert (values >= start + span[2] * tau - slack)[:, smooth].all()
    assert (values <= start + span[3] * tau + slack)[:, smooth].all()


@pytest.mark.gpu
@pytest.mark.parametrize("name", TEXTS)
def test_a_span_of_no_length_is_the_value(gl: moderngl.Context, name: str) -> None:
    o, d, s = pieces(7)
    span, values = run(gl, written(compiled_text(TEXTS[name])), o, d, 0.0 * s)
    known = span[1] - span[0] < 0.5  # a jump, or one bound giving way to another, may be right here
    assert known.mean() > 0.98
    np.testing.assert_allclose(span[0][known], values[0][known], atol=4e-6)
    np.testing.assert_allclose(span[1][known], values[0][known], atol=4e-6)


def test_its_names_are_taken() -> None:
    """No function of a scene is called like one of the library's."""
    text = (LIBRARY / "span.glsl").read_text()
    names = {line.split("(")[0].split()[-1] for line in text.splitlines() if line.startswith("vec4 ")}
    assert names and names | {"map_span", "box_distance_span"} <= RESERVED
