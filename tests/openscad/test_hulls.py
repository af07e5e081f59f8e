"""Convex hulls against their support: the farthest point in any direction is that of what spans them."""

import math

import numpy as np
import pytest
from csg_values import distance, scene

from sdfc.diagnostics import SceneError
from sdfc.openscad import outline, plane, polytope
from sdfc.openscad.plane import Disc, Polygon

RANDOM = np.random.default_rng(7)


def directions(count: int) -> np.ndarray:
    v = RANDOM.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("kind", ["ball", "sphere", "grid", "rounded"])
def test_polytope_planes_touch_and_hold_every_point(kind: str) -> None:
    grid = np.indices((5, 5, 5)).reshape(3, -1).T / 4.0
    points = {
        "ball": RANDOM.normal(size=(300, 3)),
        "sphere": directions(400),
        "grid": grid,
        "rounded": np.round(16.0 * grid @ np.linalg.qr(RANDOM.normal(size=(3, 3)))[0], 6),
    }[kind]
    made = polytope.hull([tuple(map(float, p)) for p in points])
    assert made is not None
    normals = np.array([n for n, _ in made.planes])
    offsets = np.array([d for _, d in made.planes])
    over = points @ normals.T - offsets
    assert over.max() < 1e-5
    assert (np.sort(over, axis=0)[-3:] > -1e-4).all(), "every plane touches three points"
    if kind in ("grid", "rounded"):
        assert len(made.planes) == 6
    # no plane is missing: a point pushed out along any direction by a little is outside
    far = np.array([points[np.argmax(points @ d)] + 1e-3 * d for d in directions(200)])
    assert ((far @ normals.T - offsets).max(axis=1) > 0).all()


def test_flat_points_have_no_polytope() -> None:
    assert polytope.hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (3, 5, 0)]) is None
    assert polytope.hull([(1, 2, 3)]) is None
    assert polytope.hull([]) is None


@pytest.mark.parametrize("seed", range(12))
def test_hull_of_balls(seed: int) -> None:
    """Of random radii, some 0, some within others: the level set is where the support says."""
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 9))
    centers = np.round(random.uniform(-4, 4, size=(count, 3)), 3)
    radii = np.round(random.choice([0.5, 1.0, 2.0, random.uniform(0.1, 3)], size=count), 3)
    balls = "".join(
        f"multmatrix([[1,0,0,{x}],[0,1,0,{y}],[0,0,1,{z}],[0,0,0,1]]) {{ sphere(r = {r}); }}\n"
        for (x, y, z), r in zip(centers, radii, strict=True)
    )
    text = f"hull() {{ {balls} }}"
    v = random.normal(size=(300, 3))
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    reach = v @ centers.T + radii
    best = reach.argmax(axis=1)
    surface = centers[best] + radii[best][:, None] * v
    assert (distance(text, surface + 1e-3 * v) > 0).all()
    # mixes of surface points are inside, and so are surface points drawn in a little
    mixes = 0.5 * (surface + surface[random.permutation(300)])
    middle = surface.mean(axis=0)
    assert (distance(text, middle + 0.999 * (mixes - middle)) < 0).all()
    assert (distance(text, middle + 0.999 * (surface - middle)) < 0).all()


def test_eight_equal_balls_are_one_rounded_box() -> None:
    corners = [(x, y, z) for x in (0, 6) for y in (0, 5) for z in (0, 4)]
    text = "hull() {" + "".join(
        f"multmatrix([[1,0,0,{x}],[0,1,0,{y}],[0,0,1,{z}],[0,0,0,1]]) {{ sphere(r = 1); }}" for x, y, z in corners
    )
    assert len(scene(text + "}").shapes) <= 40
    p = [(7.0, 6.0, 5.0), (3.0, 2.0, 8.0), (3.0, 2.5, 2.0)]
    assert distance(text + "}", p) == pytest.approx([math.sqrt(3.0) - 1.0, 3.0, -3.0])


def test_hull_of_discs_in_the_plane() -> None:
    made = plane.hull_of_discs([((0.0, 0.0), 2.0), ((6.0, 0.0), 1.0), ((0.5, 0.2), 0.5), ((0.0, 5.0), 0.0)])
    assert isinstance(made, plane.Joined)
    polygon, *discs = made.children
    assert isinstance(polygon, Polygon)
    assert sorted(d.radius for d in discs if isinstance(d, Disc)) == [1.0, 2.0]
    assert (0.0, 5.0) in polygon.points
    assert len(polygon.points) == 5
    assert outline.is_convex(polygon.points)


def test_hull_of_equal_things_is_the_thing() -> None:
    assert distance("hull() { sphere(r = 2); sphere(r = 1); }", [(3, 0, 0)]) == pytest.approx([1.0])
    assert distance("hull() { cube(2); cube(1); }", [(3, 1, 1)]) == pytest.approx([1.0])


def test_minkowski_of_a_box_and_a_ball_is_exact() -> None:
    text = "minkowski(convexity = 0) { cube(size = [2, 4, 6], center = true); sphere(r = 1); }"
    assert distance(text, [(2, 3, 4), (0, 0, 0), (5, 0, 0)]) == pytest.approx([math.sqrt(3) - 1, -2.0, 3.0])


def test_a_hull_of_too_many_pieces_is_of_curves() -> None:
    text = (
        "hull() {{ sphere($fn = {}, r = 2); multmatrix([[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 2{}); }}"
    )
    for end in (", $fn = 30", ""):
        made = scene(text.format(30, end))
        assert "true curves" in made.warnings[0].message
        assert distance(text.format(30, end), [(2.5, 0, 3)]) == pytest.approx([1.0])
    assert scene(text.format(5, ", $fn = 5")).warnings == ()


def test_a_stretched_ball_of_few_pieces_has_a_hull_but_a_true_one_has_none() -> None:
    text = "hull() {{ multmatrix([[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere($fn = {}, r = 1); cube(1); }}"
    assert (distance(text.format(8), [(1.7, 0, 0)]) < 0).all()
    with pytest.raises(SceneError, match="stretched"):
        scene(text.format(0))
