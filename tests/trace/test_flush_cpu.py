"""Law: faces that coincide leave no film and no crack in the float64 renderer either, whose skins are far thinner."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_flush import PAIRS, SIDE, Pair, assert_same, scene, views
from truth import Picture, compiled_text

from sdfc.api.request import View
from sdfc.pipeline import Compiled
from sdfc.reference.render import probe


def picture(compiled: Compiled, view: View, params: dict[str, tuple[float, ...]]) -> Picture:
    """As Tracing.picture, by NumPy; from the eye."""
    first, normal, position, direction = (
        np.moveaxis(a, -1, 0).reshape(4, -1) for a in probe(compiled, view, params, (SIDE, SIDE))
    )
    hit = first[3] > 0.5
    depth = np.where(hit, first[0] / compiled.plan.radius, np.nan)
    unfinished = np.zeros(hit.size, bool)
    origin = np.zeros_like(position[:3])
    return Picture(origin, direction[:3], hit, depth, normal[:3], first[1], first[2], unfinished)


@pytest.mark.parametrize("pair", PAIRS, ids=[p.name for p in PAIRS])
def test_coincident_faces(pair: Pair) -> None:
    flush, plain = (compiled_text(scene(s)) for s in (pair.flush, pair.plain))
    for turn, tilt, names in ((0.0, 0.0, ("parallel to z", "corner")), (37.0, 61.0, ("parallel to z", "grazing"))):
        params = {"turn": (math.radians(turn),), "tilt": (math.radians(tilt),)}
        for name in names:
            pictures = (picture(c, views()[name], params) for c in (flush, plain))
            assert_same(*pictures, pair.skin)
