"""The gradient of every standard field: it is the forward derivative, also where fields have kinks, and reads well."""

from __future__ import annotations

import numpy as np
import pytest
from standard_entries import NAMES, Array, Subject, default_subject

from sdfc.field.derivative import directional, gradient
from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.glsl.expression import print_function
from sdfc.scene.library import standard


def _places(subject: Subject) -> Array:
    """Random points, and points of a lattice: there faces meet, and coordinates are 0 or alike."""
    size = subject.definition.dimension
    steps = np.array([-1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0])
    lattice = np.array(np.meshgrid(*[steps] * size)).reshape(size, -1)
    return np.concatenate([subject.points(np.random.default_rng(5), 500), lattice], axis=1)


@pytest.mark.parametrize("name", NAMES)
def test_it_is_the_slope_along_each_axis(name: str) -> None:
    """Forward mode knows none of reverse mode's short cuts."""
    subject = default_subject(name)
    p, places = subject.point, _places(subject)
    for root in (subject.formula, subject.gauge):
        found = np.broadcast_to(Evaluator([gradient(root, p)])({"p": places})[0], places.shape)
        for row, unit in zip(found, np.eye(len(places)), strict=True):
            (along,) = Evaluator([directional(root, {p: subject.graph.constant(*unit)})])({"p": places})
            assert np.allclose(row, along, rtol=1e-7, atol=1e-7)


def _printed(name: str, gauge: bool = False) -> list[str]:
    """The statements of gradient and value of a standard primitive whose parameters are numbers."""
    graph = FieldGraph()
    definition = standard(name, graph)
    p = graph.input("p")
    types = {v.name: Type.VEC3 if v.name == "size" else Type.FLOAT for v in definition.values}
    arguments = {name: graph.input(name, type_) for name, type_ in types.items()}
    formula = definition.claims.gauge if gauge else None
    value: Expr = formula(p, arguments) if formula else definition.formula(p, arguments, {})
    slope = gradient(value, p)
    result = graph.vector(slope[0], slope[1], slope[2], value)
    text = print_function(Function(name, (("p", Type.VEC3), *types.items()), result))
    return [line.strip() for line in text.splitlines()[1:-1]]


def test_gradients_are_as_short_as_by_hand() -> None:
    assert _printed("sphere") == ["float len = length(p);", "return vec4(p / max(len, 1e-30), len - radius);"]
    face = "d <= q.z ? vec3(0.0, 0.0, 1.0) : d <= q.y ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)"
    assert _printed("box", gauge=True) == [
        "vec3 q = abs(p) - size / 2.0;",
        "float d = max(q.x, max(q.y, q.z));",
        f"vec3 q_2 = {face};",
        "return vec4(q_2 * sign(sign(p) + 0.5), d);",
    ]
    assert _printed("box") == [
        "vec3 q = abs(p) - size / 2.0;",
        "float d = max(q.x, max(q.y, q.z));",
        f"vec3 q_2 = {face};",
        "vec3 q_3 = max(q, 0.0);",
        "float len = length(q_3);",
        "vec3 q_4 = ((d <= 0.0 ? q_2 : vec3(0.0)) + q_3 / max(len, 1e-30)) * sign(sign(p) + 0.5);",
        "return vec4(q_4, len + min(d, 0.0));",
    ]
    assert len(_printed("cylinder")) == 9
    assert len(_printed("rounded_box")) == 7
