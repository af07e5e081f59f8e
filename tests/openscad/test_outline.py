"""Polygons taken apart, offset and turned inside out."""

import math

import numpy as np
import pytest

from sdfc.openscad import outline
from sdfc.openscad.outline import Pocketed
from sdfc.openscad.refusal import RefusalError

NOTCHED = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.5), (0.0, 4.0))
SPIRAL = tuple(
    [(math.cos(0.5 * i) * (1 + 0.1 * i), math.sin(0.5 * i) * (1 + 0.1 * i)) for i in range(40)]
    + [(math.cos(0.5 * i) * (0.8 + 0.1 * i), math.sin(0.5 * i) * (0.8 + 0.1 * i)) for i in reversed(range(40))]
)
CROSS = ((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0))


def within(region: Pocketed, x: float, y: float) -> bool:
    if any(a * x + b * y > d for (a, b), d in region.sides):
        return False
    return not any(within(pocket, x, y) for pocket in region.pockets)


@pytest.mark.parametrize("points", [NOTCHED, tuple(reversed(NOTCHED)), SPIRAL, outline.regular(7, 2.0)])
def test_pockets_give_the_polygon_back(points: tuple[outline.Point2, ...]) -> None:
    region = outline.pocketed(points)
    for x, y in np.random.default_rng(3).uniform(-6, 6, size=(500, 2)):
        assert within(region, x, y) == outline.contains(points, (x, y))


def test_simple_and_convex() -> None:
    assert outline.is_simple(NOTCHED)
    assert outline.is_simple(SPIRAL)
    assert not outline.is_simple(CROSS)
    star = [(math.cos(0.8 * math.pi * i), math.sin(0.8 * math.pi * i)) for i in range(5)]
    assert not outline.is_convex(star), "it turns to one side only, but twice around"
    assert outline.is_convex(outline.regular(40, 1.0))
    assert not outline.is_convex(NOTCHED)


def test_offsets() -> None:
    square = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
    assert outline.area(outline.mitred(square, 1.0)) == pytest.approx(36.0)
    assert outline.area(outline.mitred(tuple(reversed(square)), -1.0)) == pytest.approx(4.0)
    assert abs(outline.area(outline.shrunk(square, 1.5))) == pytest.approx(1.0)
    assert outline.shrunk(square, 2.0) == ()
    with pytest.raises(RefusalError):
        outline.mitred(NOTCHED, -2.0)


def test_what_has_no_area_is_cleaned_away() -> None:
    assert outline.cleaned([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (0.0, 0.0)]) == ()
    assert outline.cleaned([(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]) == ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))


def test_regular_form() -> None:
    turned = [
        (3.0 + 2.0 * math.cos(0.4 + 0.3 * math.pi * i / 3), -1.0 + 2.0 * math.sin(0.4 + 0.3 * math.pi * i / 3))
        for i in range(20)
    ]
    made = outline.regular_form([(round(x, 5), round(y, 5)) for x, y in turned])
    assert made is not None
    assert made.count == 20
    assert (*made.center, made.radius, made.phase) == pytest.approx((3.0, -1.0, 2.0, 0.4), abs=1e-4)
    assert outline.regular_form(list(reversed(turned))) is not None
    assert outline.regular_form(turned[1:]) is None
    assert outline.regular_form([(x, 1.001 * y) for x, y in turned]) is None
    assert outline.regular_form([turned[2 * i % 20] for i in range(20)]) is None
