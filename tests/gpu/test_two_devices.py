"""Law: two devices of one process do not disturb each other, nor does one that is closed the other."""

from __future__ import annotations

import numpy as np
import pytest

import sdfc

pytestmark = pytest.mark.gpu

BALL = "camera { eye: [0, 0, 4], target: [0, 0, 0] } scene { sphere(radius: 0.5) }"
BLOCK = "camera { eye: [0, 0, 4], target: [0, 0, 0] } scene { box(size: [1, 0.4, 1]) }"
SIZE = (32, 24)


def test_two_programs_draw_in_turn(device: object) -> None:
    with sdfc.compile(BALL) as ball, sdfc.compile(BLOCK) as block:
        first = [p.render(SIZE, backend="gl").depth for p in (ball, block)]
        again = [p.render(SIZE, backend="gl").depth for p in (ball, block)]
        with sdfc.compile(BALL) as passing:
            passing.render(SIZE, backend="gl")
        last = [p.render(SIZE, backend="gl", tracer="sphere").depth for p in (ball, block)]
    for a, b, c in zip(first, again, last, strict=True):
        np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(np.isfinite(a), np.isfinite(c))
    assert not np.array_equal(first[0], first[1])
