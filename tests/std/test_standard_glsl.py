"""The GLSL of every standard field on the GPU, against float64."""

from __future__ import annotations

import numpy as np
import pytest
from standard_entries import NAMES, Array, Subject, default_subject, names_where

from sdfc.field.function import Function
from sdfc.field.graph import Expr, Type
from sdfc.field.numeric import Evaluator
from sdfc.glsl.expression import print_function
from sdfc.gpu.device import Device
from sdfc.gpu.program import COVERING

pytestmark = pytest.mark.gpu

_SIDE = 48
_WITH_RAYS = names_where(lambda d: d.claims.ray is not None)


def _computed(device: Device, function: Function, *tables: Array) -> Array:
    """`function` of each column of the tables (3, n), on the device: (4, n), what it has no component for is 0."""
    context = device.context
    size = (_SIDE, _SIDE)
    textures = []
    for table in tables:
        rows = np.zeros((_SIDE * _SIDE, 4), np.float32)
        rows[:, : len(table)] = table.T
        textures.append(context.texture(size, 4, rows.tobytes(), dtype="f4"))
    samplers = "\n".join(f"layout(binding = {i}) uniform sampler2D table_{i};" for i in range(len(tables)))
    swizzles = {Type.VEC2: ".xy", Type.VEC3: ".xyz", Type.FLOAT: ".x"}
    fetched = [
        f"texelFetch(table_{i}, ivec2(gl_FragCoord.xy), 0){swizzles[type_]}"
        for i, (_, type_) in enumerate(function.parameters)
    ]
    zeros = ", 0.0" * (4 - function.result.type.size)
    program = context.program(
        vertex_shader=COVERING,
        fragment_shader=f"#version 450 core\n{samplers}\nout vec4 result;\n{print_function(function)}\n"
        f"void main() {{ result = vec4({function.name}({', '.join(fetched)}){zeros}); }}\n",
    )
    target = context.texture(size, 4, dtype="f4")
    frame = context.framebuffer([target])
    frame.use()
    for i, texture in enumerate(textures):
        texture.use(i)
    context.vertex_array(program, []).render(vertices=3)
    values = np.frombuffer(target.read(), np.float32).reshape(-1, 4).T.astype(float)
    for made in (*textures, target, frame, program):
        made.release()
    return values


def _points(subject: Subject, seed: int, spread: float) -> Array:
    points = subject.points(np.random.default_rng(seed), _SIDE * _SIDE, spread)
    return points.astype(np.float32).astype(float)


@pytest.mark.parametrize("name", NAMES)
def test_formula(name: str, device: Device) -> None:
    subject = default_subject(name)
    points = _points(subject, 1, 1.5)
    function = Function("formula", (("p", Type(len(points))),), subject.formula)
    found = _computed(device, function, points)[0]
    assert np.abs(found - subject.value(points)).max() <= 2e-5 * subject.scale


@pytest.mark.parametrize("name", _WITH_RAYS)
def test_ray(name: str, device: Device) -> None:
    """The same intervals, but for lines that graze: those may be a little longer or not there."""
    subject = default_subject(name)
    origins, targets = _points(subject, 1, 2.0), _points(subject, 2, 0.8)
    directions = (targets - origins).astype(np.float32).astype(float)
    directions[0, :50] = 0.0
    directions[1, 25:75] = 0.0
    graph, ray = subject.graph, subject.definition.claims.ray
    assert ray is not None
    intervals = ray(graph.input("o"), graph.input("d"), graph.constant(0.0), subject.arguments)
    ends: list[Expr] = [end for interval in intervals for end in interval]
    function = Function("ray", (("o", Type.VEC3), ("d", Type.VEC3)), graph.vector(*ends))
    found = _computed(device, function, origins, directions)
    wanted = np.array(Evaluator(ends)({"o": origins, "d": directions}))
    assert np.isfinite(found).all()
    for k in range(0, len(ends), 2):
        enter, leave = found[k], found[k + 1]
        length = np.clip(wanted[k + 1], -1e3, 1e3) - np.clip(wanted[k], -1e3, 1e3)
        clear = np.abs(length) > 0.05  # not where it grazes, nor where all is far away
        assert ((enter < leave) == (length > 0))[clear].all()
        hit = clear & (length > 0)
        for got, right in ((enter, wanted[k]), (leave, wanted[k + 1])):
            near = hit & (np.abs(right) < 20.0)
            assert (np.abs(got - right)[near] <= 5e-3).all()
