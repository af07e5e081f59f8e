"""A user's field loses the factors around a field of the same zeros, and only where its values do not count."""

from __future__ import annotations

import numpy as np
import pytest
from truth import compiled_text

from sdfc.field.core import same_zeros
from sdfc.field.numeric import Evaluator
from sdfc.shape.graph import Apply, Shape, topological
from sdfc.shape.lower import lower

_BALL = "length(p) - 0.5"
LOSES = {
    "squared": "d * abs(d)",
    "cubed": "d * d * d",
    "fifth": "d * d * d * d * d",
    "scaled": "0.001 * d",
    "divided": "d / (1 + 4 * abs(d))",
    "steeper outside": "d * (0.01 + (d - 0.2) * (d - 0.2))",
    "weighted": "exp(-p.x) * d",
}
KEEPS = {
    "negative": "-0.5 * d",
    "even": "d * d - 0.01",
    "zero elsewhere": "d * abs(p.x)",
    "zero beyond": "d * max(p.x, 0)",
    "changes sign": "d * p.x",
    "a root": "d * sqrt(abs(p.x))",
}


def scene(formula: str, solid: str = "own()") -> str:
    return f"field own() = {formula} where d = {_BALL} bounds -[1, 1, 1] .. [1, 1, 1]\nscene {{ {solid} box() }}"


def own(root: Shape) -> Apply:
    (found,) = (n for n in topological(root) if isinstance(n, Apply) and n.definition.name == "own")
    return found


@pytest.mark.parametrize("formula", [*LOSES.values(), *KEEPS.values()], ids=[*LOSES, *KEEPS])
def test_the_same_signs_and_zeros(formula: str) -> None:
    compiled = compiled_text(scene(formula), "proven")
    before = own(compiled.scene.root)
    values = compiled.scene.values
    p = np.random.default_rng(3).uniform(-1, 1, (3, 4000))
    p[:, :500] *= 0.5 / np.linalg.norm(p[:, :500], axis=0)  # at the surface, or a rounding off
    p[0, 500:600] = 0.0
    root = lower(before, values.input("p"))
    whole, core = (np.broadcast_to(v, 4000) for v in Evaluator([root, same_zeros(root)])({"p": p}, {}))
    clear = (np.abs(core) > 1e-12) | (whole == 0.0)
    np.testing.assert_array_equal(np.sign(whole)[clear], np.where(np.abs(core) > 1e-12, np.sign(core), 0.0)[clear])
    assert (same_zeros(root) is not root) == (formula in LOSES.values())


@pytest.mark.parametrize("formula", LOSES.values(), ids=LOSES)
def test_what_is_traced_is_the_distance(formula: str) -> None:
    compiled = compiled_text(scene(formula))
    at = compiled.scene.values.input("p")
    plain = compiled_text(scene("d"))
    core = Evaluator([lower(own(compiled.shape), at)])({"p": np.ones((3, 1))}, {})[0]
    assert core == Evaluator([lower(own(plain.shape), plain.scene.values.input("p"))])({"p": np.ones((3, 1))}, {})[0]


def test_values_that_count_are_kept() -> None:
    """An operation works on what its author wrote; nor is what is claimed of it lost."""
    for solid in ("own().round(0.01)", "union(blend: 0.1) { own() sphere(radius: 0.3) }"):
        compiled = compiled_text(scene(LOSES["scaled"], solid))
        assert own(compiled.shape).definition is own(compiled.scene.root).definition
    claimed = (
        "field own() = 0.001 * (length(p) - 0.5) bounds -[1, 1, 1] .. [1, 1, 1] lipschitz 0.001\nscene { own() box() }"
    )
    compiled = compiled_text(claimed)
    assert own(compiled.shape).definition is own(compiled.scene.root).definition
