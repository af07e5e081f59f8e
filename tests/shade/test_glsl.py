"""Every shading function on the GPU gives what float64 gives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from evaluate import function, run, unit

from sdfc.field.graph import Type
from sdfc.shade.ambient import OCCLUSION_HEIGHTS
from sdfc.shade.functions import FUNCTIONS

COUNT = 2000
UNIT_VECTORS = ("direction", "up", "toward", "normal", "view", "light")


def inputs(name: str) -> dict[str, Any]:
    """Random inputs in the ranges that the functions are for."""
    random = np.random.default_rng(7)
    given: dict[str, Any] = {}
    for parameter, type_ in function(name).parameters:
        match parameter, type_:
            case "distances", _:
                given[parameter] = random.uniform(-0.1, 0.3, (4, COUNT))
            case "heights", _:
                given[parameter] = np.repeat(np.array(OCCLUSION_HEIGHTS)[:, None], COUNT, axis=1)
            case "ior", _:
                given[parameter] = random.uniform(1.0, 2.5, COUNT)
            case _, Type.FLOAT:
                given[parameter] = random.uniform(0.0, 1.0, COUNT)
            case _ if parameter in UNIT_VECTORS:
                given[parameter] = unit(random.normal(size=(3, COUNT)))
            case _:
                given[parameter] = random.uniform(0.0, 1.0, (3, COUNT))
    return {parameter: np.asarray(value, np.float32).astype(float) for parameter, value in given.items()}


@pytest.mark.gpu
@pytest.mark.parametrize("name", list(FUNCTIONS))
def test_glsl_is_float64(run_function: Callable[..., Any], name: str) -> None:
    given = inputs(name)
    exact = run(name, **given)
    found = run_function(function(name), given)
    assert np.all(np.isfinite(found))
    # a narrow highlight has a steep flank: its error is relative to its own height
    assert np.abs(found - exact).max() < 2e-4 * (1.0 + np.abs(exact).max())
    assert np.median(np.abs(found - exact)) < 1e-5
