"""The certified truth against closed forms and against interval CSG; films, tangents, faces, infinities."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdfc.field.graph import Expr, FieldGraph, Op
from sdfc.field.numeric import Evaluator
from sdfc.reference.certify import Certificate, Status, first_roots
from sdfc.reference.events import Both, Either, Leaf, Solid, Without, first_runs

Rays = tuple[np.ndarray, np.ndarray]


def sphere(p: Expr, centre: tuple[float, float, float], radius: float) -> Expr:
    return p.graph.length(p - p.graph.constant(*centre)) - radius


def box(p: Expr, centre: tuple[float, float, float], half: tuple[float, float, float]) -> Expr:
    graph = p.graph
    q = graph.abs(p - graph.constant(*centre)) - graph.constant(*half)
    return graph.length(graph.max(q, 0.0)) + graph.min(graph.max(q[0], graph.max(q[1], q[2])), 0.0)


def sphere_leaf(rays: Rays, centre: tuple[float, float, float], radius: float) -> Leaf:
    o, d = rays
    away = o - np.array(centre)[:, None]
    squared = np.sum(d * d, axis=0)
    nearest = -np.sum(away * d, axis=0) / squared
    across = away + nearest * d
    with np.errstate(invalid="ignore"):
        half = np.sqrt((radius**2 - np.sum(across * across, axis=0)) / squared)
    return Leaf((nearest - half)[None], (nearest + half)[None])


def box_leaf(rays: Rays, centre: tuple[float, float, float], half: tuple[float, float, float]) -> Leaf:
    o, d = rays
    away = o - np.array(centre)[:, None]
    d = np.where(d == 0.0, 1e-300, d)
    first, second = (-away - np.array(half)[:, None]) / d, (-away + np.array(half)[:, None]) / d
    return Leaf(np.minimum(first, second).max(axis=0)[None], np.maximum(first, second).min(axis=0)[None])


def random_rays(count: int, seed: int, distance: float = 5.0) -> Rays:
    """Rays from a sphere around the origin to points near it, in float32 numbers."""
    random = np.random.default_rng(seed)
    o = random.normal(size=(3, count))
    o *= distance / np.linalg.norm(o, axis=0)
    d = random.uniform(-1.2, 1.2, (3, count)) - o
    d /= np.linalg.norm(d, axis=0)
    return o.astype(np.float32).astype(float), d.astype(np.float32).astype(float)


def ray(o: tuple[float, float, float], d: tuple[float, float, float]) -> Rays:
    return np.array(o, float)[:, None], np.array(d, float)[:, None]


def certify(build: Callable[[Expr], Expr], rays: Rays, t_end: float = 20.0, **options: float) -> Certificate:
    return first_roots(build(FieldGraph().input("p")), *rays, 0.0, t_end, **options)


def check(truth: Certificate, hit: np.ndarray, t: np.ndarray) -> None:
    """The certificate says what the closed form says, up to the closed form's own rounding at a grazing hit."""
    assert (truth.status != Status.AMBIGUOUS).all()
    assert ((truth.status == Status.HIT) == hit).all()
    assert (truth.t_lo[hit] - 1e-12 <= t[hit]).all() and (t[hit] <= truth.t_hi[hit] + 1e-12).all()
    assert (truth.t_hi[hit] - truth.t_lo[hit]).max(initial=0.0) < 3e-10


def test_a_sphere_is_hit_where_the_quadratic_says() -> None:
    rays = random_rays(4000, 1)
    expected = first_runs(sphere_leaf(rays, (0.1, 0.2, -0.3), 0.8), 0.0, 20.0)
    assert 500 < expected.hit.sum() < 3500
    check(certify(lambda p: sphere(p, (0.1, 0.2, -0.3), 0.8), rays), expected.hit, expected.t)


def test_a_box_is_hit_where_the_slabs_say() -> None:
    rays = random_rays(4000, 2)
    expected = first_runs(box_leaf(rays, (0.1, 0.0, 0.2), (0.5, 0.9, 0.3)), 0.0, 20.0)
    check(certify(lambda p: box(p, (0.1, 0.0, 0.2), (0.5, 0.9, 0.3)), rays), expected.hit, expected.t)


def test_a_torus_is_hit_at_the_first_root_of_its_quartic() -> None:
    rays = random_rays(300, 3)

    def torus(p: Expr) -> Expr:
        graph = p.graph
        return graph.length(graph.vector(graph.length(p.swizzle("xz")) - 0.8, p[1])) - 0.25

    truth = certify(torus, rays)
    for i, (o, d) in enumerate(zip(rays[0].T, rays[1].T, strict=True)):
        # (|x|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2), along the ray
        whole = np.array([d @ d, 2.0 * (o @ d), o @ o + 0.8**2 - 0.25**2])
        flat = np.array([d[0] ** 2 + d[2] ** 2, 2.0 * (o[0] * d[0] + o[2] * d[2]), o[0] ** 2 + o[2] ** 2])
        roots = np.roots(np.polysub(np.polymul(whole, whole), 4.0 * 0.8**2 * flat))
        real = np.sort(roots[np.abs(roots.imag) < 1e-7].real)
        assert (truth.status[i] == Status.HIT) == bool(real.size)
        if real.size:
            assert truth.t_lo[i] == pytest.approx(real[0], abs=1e-6)
    assert 50 < (truth.status == Status.HIT).sum() < 280


@st.composite
def solids(draw: st.DrawFn) -> tuple[Callable[[Expr], Expr], Callable[[Rays], Solid]]:
    """A random hard CSG of spheres and boxes: as a field, and as ray intervals."""
    place = st.tuples(*[st.sampled_from([-0.6, -0.25, 0.0, 0.3, 0.5])] * 3)
    size = st.sampled_from([0.2, 0.45, 0.7])
    parts: list[tuple[Callable[[Expr], Expr], Callable[[Rays], Solid]]] = []
    for _ in range(draw(st.integers(2, 6))):
        c, r = draw(place), draw(size)
        if draw(st.booleans()):
            parts.append((lambda p, c=c, r=r: sphere(p, c, r), lambda rays, c=c, r=r: sphere_leaf(rays, c, r)))
        else:
            h = (r, draw(size), draw(size))
            parts.append((lambda p, c=c, h=h: box(p, c, h), lambda rays, c=c, h=h: box_leaf(rays, c, h)))
    (field, solid), *rest = parts
    for f, s in rest:
        match draw(st.sampled_from(["either", "both", "without", "without"])):
            case "either":
                field, solid = (
                    _pair(field, f, lambda g, a, b: g.min(a, b)),
                    _merge(solid, s, lambda a, b: Either((a, b))),
                )
            case "both":
                field, solid = _pair(field, f, lambda g, a, b: g.max(a, b)), _merge(solid, s, lambda a, b: Both((a, b)))
            case _:
                field, solid = _pair(field, f, lambda g, a, b: g.max(a, -b)), _merge(solid, s, Without)
    return field, solid


def _pair(a: Callable, b: Callable, join: Callable) -> Callable[[Expr], Expr]:
    return lambda p: join(p.graph, a(p), b(p))


def _merge(a: Callable, b: Callable, join: Callable) -> Callable[[Rays], Solid]:
    return lambda rays: join(a(rays), b(rays))


@settings(max_examples=40, deadline=None)
@given(solids(), st.integers(0, 2**31))
def test_random_csg_agrees_with_merged_ray_intervals(
    pair: tuple[Callable[[Expr], Expr], Callable[[Rays], Solid]], seed: int
) -> None:
    """Coplanar faces included (the sizes and places are few): `thin` must settle films the same way on both sides."""
    field, solid = pair
    rays = random_rays(300, seed)
    expected = first_runs(solid(rays), 0.0, 20.0, thin=1e-6)
    truth = certify(field, rays, thin=1e-6, tolerance=1e-7)
    sure = ~truth.contested
    assert sure.sum() > 200
    assert ((truth.status == Status.HIT) == expected.hit)[sure].all()
    both = sure & expected.hit
    assert np.abs(truth.t_lo[both] - expected.t[both]).max(initial=0.0) < 1e-9


@pytest.mark.parametrize("lipschitz", [None, 1.0])
def test_a_lipschitz_constant_changes_the_time_not_the_truth(lipschitz: float | None) -> None:
    rays = random_rays(500, 5)
    truth = certify(lambda p: p.graph.max(sphere(p, (0, 0, 0), 1.0), -box(p, (0, 0, 0), (2, 0.3, 0.4))), rays)
    other = certify(
        lambda p: p.graph.max(sphere(p, (0, 0, 0), 1.0), -box(p, (0, 0, 0), (2, 0.3, 0.4))), rays, lipschitz=lipschitz
    )
    assert (truth.status == other.status).all()
    hit = truth.status == Status.HIT
    assert np.abs(truth.t_lo[hit] - other.t_lo[hit]).max() < 1e-9


def test_no_field_is_distance_like_enough_to_matter() -> None:
    """A bumpy, steep, twisted field: dense samples never find solid before t_lo, and find it right after t_hi."""

    def twisted(p: Expr) -> Expr:
        graph = p.graph
        angle = 2.0 * p[1]
        c, s = graph.call(Op.COS, angle), graph.call(Op.SIN, angle)
        q = graph.vector(c * p[0] - s * p[2], p[1], s * p[0] + c * p[2])
        bumps = graph.call(Op.SIN, 9.0 * p[0]) * graph.call(Op.SIN, 8.0 * p[1]) * graph.call(Op.SIN, 7.0 * p[2])
        return 5.0 * box(q, (0.0, 0.0, 0.0), (0.5, 0.8, 0.3)) + 0.3 * bumps

    rays = random_rays(400, 6)
    root = twisted(FieldGraph().input("p"))
    truth = first_roots(root, *rays, 0.0, 10.0)
    assert (truth.status == Status.AMBIGUOUS).sum() == 0
    hit = truth.status == Status.HIT
    assert 80 < hit.sum() < 380
    before = np.where(hit, truth.t_lo, 10.0) * np.linspace(0.0, 1.0, 3000)[:, None]
    for t in before:
        assert (Evaluator([root])({"p": rays[0] + t * rays[1]})[0] > -1e-12).all()
    inside = rays[0][:, hit] + truth.t_hi[hit] * rays[1][:, hit]
    assert (Evaluator([root])({"p": inside})[0] <= 0.0).all()


@pytest.mark.parametrize("offset", [1e-4, 1e-6, 1e-8, 1e-10])
def test_near_tangent_rays_are_decided(offset: float) -> None:
    """r (1 -/+ 1e-k) past a unit sphere: a hit and a miss, both contested at a tolerance above the depth."""
    o = np.array([[-3.0, -3.0], [1.0 - offset, 1.0 + offset], [0.0, 0.0]])
    d = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    truth = certify(lambda p: sphere(p, (0.0, 0.0, 0.0), 1.0), (o, d), tolerance=2.0 * offset)
    assert truth.status.tolist() == [Status.HIT, Status.MISS]
    assert truth.t_lo[0] == pytest.approx(3.0 - np.sqrt(1.0 - (1.0 - offset) ** 2), abs=1e-9)
    assert truth.contested.tolist() == [True, True]
    sure = certify(lambda p: sphere(p, (0.0, 0.0, 0.0), 1.0), (o, d), tolerance=0.5 * offset)
    assert sure.contested.tolist() == [False, False]
    assert 0.5 * offset <= sure.clearance[1] <= offset


def test_an_exact_tangent_is_ambiguous() -> None:
    truth = certify(lambda p: sphere(p, (0.0, 0.0, 0.0), 1.0), ray((-3.0, 1.0, 0.0), (1.0, 0.0, 0.0)))
    assert truth.status[0] == Status.AMBIGUOUS and truth.contested[0]
    assert truth.t_lo[0] == pytest.approx(3.0, abs=1e-5)


def test_a_ray_within_a_face_is_ambiguous() -> None:
    truth = certify(
        lambda p: box(p, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), ray((-3.0, 1.0, 0.0), (1.0, 0.0, 0.0)), thin=1e-6
    )
    assert truth.status[0] == Status.AMBIGUOUS
    assert truth.t_lo[0] == pytest.approx(2.0, abs=1e-6)


def film(p: Expr) -> Expr:
    """A unit box less an equal box shifted by a hair: a film on one face, and a ball far behind it."""
    hair = 1e-12
    cut = p.graph.max(box(p, (0, 0, 0), (1, 1, 1)), -box(p, (hair, 0, 0), (1, 1, 1)))
    return p.graph.min(cut, sphere(p, (5.0, 0.0, 0.0), 1.0))


def test_a_film_counts_as_nothing() -> None:
    rays = ray((-3.0, 0.1, 0.2), (1.0, 0.0, 0.0))
    through = certify(film, rays, thin=1e-6)
    assert through.status[0] == Status.HIT and through.contested[0]
    assert through.t_lo[0] == pytest.approx(8.0 - np.sqrt(1.0 - 0.05), abs=1e-9)
    miss = certify(film, rays, t_end=6.0, thin=1e-6)
    assert miss.status[0] == Status.MISS and miss.contested[0] and miss.clearance[0] == 0.0
    thick = certify(lambda p: p.graph.max(film(p), sphere(p, (0, 0, 0), 3)), rays)
    assert thick.status[0] != Status.MISS


def test_flush_faces_that_cancel_exactly_are_passed() -> None:
    """A - A has distance 0 on its whole boundary, no inside: a ray crosses it twice and misses."""
    both = certify(
        lambda p: p.graph.max(box(p, (0, 0, 0), (1, 1, 1)), -box(p, (0, 0, 0), (1, 1, 1))),
        ray((-3.0, 0.1, 0.2), (1.0, 0.05, 0.02)),
        thin=1e-6,
    )
    assert both.status[0] == Status.MISS and both.contested[0]


def test_touching_solids_have_no_gap() -> None:
    """Two boxes that share a face, seen from inside the first: the union is entered once."""
    truth = certify(
        lambda p: p.graph.min(box(p, (0, 0, 0), (1, 1, 1)), box(p, (2, 0, 0), (1, 1, 1))),
        ray((-3.0, 0.1, 0.2), (1.0, 0.0, 0.0)),
        tolerance=1e-6,
        thin=1e-6,
    )
    assert truth.status[0] == Status.HIT and not truth.contested[0] and truth.t_lo[0] == pytest.approx(2.0)


def test_a_start_inside_is_a_hit_at_once() -> None:
    truth = certify(
        lambda p: sphere(p, (0, 0, 0), 1.0), ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)), tolerance=1e-3, thin=1e-6
    )
    assert truth.status[0] == Status.HIT and truth.t_lo[0] == 0.0 and not truth.contested[0]


def test_a_separate_dip_before_the_hit_is_contested() -> None:
    """The ray passes a ball at 1e-5 before it hits a wall: with a tolerance of 1e-4 the ball may be hit."""

    def dip(p: Expr) -> Expr:
        return p.graph.min(sphere(p, (0.0, 1.0, 0.0), 1.0), box(p, (4.0, 0.0, 0.0), (1.0, 1.0, 1.0)))

    rays = ray((-3.0, -1e-5, 0.0), (1.0, 0.0, 0.0))
    loose, tight = certify(dip, rays, tolerance=1e-4), certify(dip, rays, tolerance=1e-6)
    assert loose.contested[0] and not tight.contested[0]
    assert loose.t_early[0] < 3.0 < loose.t_lo[0] == pytest.approx(6.0)
    assert tight.t_early[0] == pytest.approx(6.0 - 1e-6) and tight.t_late[0] == pytest.approx(6.0 + 1e-6)


def test_a_plate_thinner_than_the_tolerance_is_contested() -> None:
    rays = ray((-3.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    for half, contested in ((1e-3, False), (1e-5, True)):
        plate = certify(lambda p, half=half: box(p, (0, 0, 0), (half, 1, 1)), rays, tolerance=1e-4, thin=1e-7)
        assert plate.status[0] == Status.HIT and plate.contested[0] == contested


def test_the_end_is_the_end() -> None:
    rays = ray((0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    wall = certify(lambda p: 3.0 - p[2], rays, t_end=1.499999)
    assert wall.status[0] == Status.MISS and 0.0 < wall.clearance[0] <= 3e-6
    assert certify(lambda p: 3.0 - p[2], rays, t_end=1.500001).status[0] == Status.HIT


def test_an_infinite_ray_ends() -> None:
    rays = random_rays(200, 7)
    truth = certify(lambda p: sphere(p, (0, 0, 0), 0.8), rays, t_end=np.inf)
    expected = first_runs(sphere_leaf(rays, (0, 0, 0), 0.8), 0.0, np.inf)
    check(truth, expected.hit, expected.t)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("offset", [0.0, 1e3])
def test_scale_and_distance_from_the_origin_do_not_matter(scale: float, offset: float) -> None:
    o, d = random_rays(200, 8)
    o = o * scale + offset * scale
    truth = first_roots(
        sphere(FieldGraph().input("p"), (offset * scale,) * 3, 0.8 * scale), o, d, 0.0, 20.0 * scale, thin=1e-7 * scale
    )
    expected = first_runs(sphere_leaf((o, d), (offset * scale,) * 3, 0.8 * scale), 0.0, 20.0 * scale)
    assert ((truth.status == Status.HIT) == expected.hit).all()
    close = 1e-10 * scale * (1.0 + offset)
    assert np.abs(truth.t_lo[expected.hit] - expected.t[expected.hit]).max() < 20.0 * close


def test_a_jump_is_a_boundary_too() -> None:
    """A field that jumps over zero has a run of solid behind the jump, found without any slope."""
    truth = certify(
        lambda p: p.graph.select(p[2] < 1.0, 1.0, -1.0),
        ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        thin=1e-6,
        tolerance=1e-3,
    )
    assert truth.status[0] == Status.HIT and truth.t_lo[0] == pytest.approx(1.0) and truth.t_hi[0] >= 1.0


def test_a_field_that_is_not_a_number_is_never_called_empty() -> None:
    truth = certify(lambda p: p.graph.sqrt(p[2] - 100.0), ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    assert truth.status[0] != Status.MISS


def test_params_reach_the_field() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.length(p) - graph.param("r")
    rays = ray((-3.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    for radius in (0.5, 1.5):
        assert first_roots(root, *rays, 0.0, 9.0, {"r": radius}).t_lo[0] == pytest.approx(3.0 - radius)


def repeated(p: Expr, spacing: float = 1.0) -> Expr:
    graph = p.graph
    cell = graph.call(Op.MOD, p + 0.5 * spacing, spacing) - 0.5 * spacing
    return graph.max(graph.length(cell) - 0.3, sphere(p, (0.0, 0.0, 0.0), 1.9))


def test_cell_borders_of_a_repetition_are_not_films() -> None:
    """mod jumps from 1 to 0 where the distance does not: the ray goes on, and nothing there is contested."""
    rays = random_rays(400, 9)
    truth = certify(repeated, rays, tolerance=1e-6, thin=1e-7)
    places = [(x, y, z) for x in range(-2, 3) for y in range(-2, 3) for z in range(-2, 3)]
    balls = Either(tuple(sphere_leaf(rays, place, 0.3) for place in places))
    expected = first_runs(Both((balls, sphere_leaf(rays, (0.0, 0.0, 0.0), 1.9))), 0.0, 20.0)
    assert truth.contested.sum() <= 1
    assert ((truth.status == Status.HIT) == expected.hit)[~truth.contested].all()
    both = expected.hit & ~truth.contested
    assert np.abs(truth.t_lo[both] - expected.t[both]).max() < 1e-9


def test_a_border_crossed_in_three_directions_at_once_is_crossed() -> None:
    rays = ray((-0.75, -0.75, -0.75), (1.0, 1.0, 1.0))
    hollow = certify(lambda p: 0.95 - repeated(p), rays, t_end=1.25 + 2.0**-20, thin=1e-9)
    assert hollow.status[0] == Status.MISS


def test_a_polar_repetition_crosses_the_branch_cut() -> None:
    def petals(p: Expr) -> Expr:
        graph = p.graph
        angle, radius = graph.call(Op.ATAN2, p[2], p[0]), graph.length(p.swizzle("xz"))
        turn = 2.0 * np.pi / 6
        angle = angle - turn * graph.call(Op.ROUND, angle / turn)
        q = graph.vector(radius * graph.call(Op.COS, angle) - 1.0, p[1], radius * graph.call(Op.SIN, angle))
        return graph.length(q) - 0.3

    rays = random_rays(400, 10)
    truth = certify(petals, rays, tolerance=1e-6, thin=1e-7)
    angles = np.arange(6) * np.pi / 3
    balls = Either(tuple(sphere_leaf(rays, (np.cos(a), 0.0, np.sin(a)), 0.3) for a in angles))
    expected = first_runs(balls, 0.0, 20.0)
    assert truth.contested.sum() <= 1
    assert ((truth.status == Status.HIT) == expected.hit)[~truth.contested].all()


def test_a_wall_behind_a_jump_is_not_jumped() -> None:
    """The field is discontinuous at the cell border and solid beyond it."""
    truth = certify(
        lambda p: 0.5 - p.graph.call(Op.FLOOR, p[2]), ray((0.0, 0.0, 0.5), (0.0, 0.0, 1.0)), tolerance=1e-3, thin=1e-6
    )
    assert truth.status[0] == Status.HIT and truth.t_lo[0] == pytest.approx(0.5)


def test_a_polygon_has_no_films_at_the_height_of_its_corners() -> None:
    """The winding's comparisons flip in pairs there; the ray passes beside the triangle."""

    def triangle(p: Expr) -> Expr:
        graph = p.graph
        corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        squares, sign = graph.constant(np.inf), graph.constant(1.0)
        for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
            e, w = graph.constant(bx - ax, by - ay), p.swizzle("xy") - graph.constant(ax, ay)
            along = graph.clamp(graph.dot(w, e) / graph.dot(e, e), 0.0, 1.0)
            squares = graph.min(squares, graph.dot(w - e * along, w - e * along))
            above, under = graph.add(Op.LESS_EQUAL, graph.constant(ay), p[1]), p[1] < by
            left = graph.add(Op.LESS, e[1] * w[0], e[0] * w[1])
            every = graph.add(Op.AND, graph.add(Op.AND, above, under), left)
            none = graph.add(Op.OR, graph.add(Op.OR, above, under), left)
            sign = sign * graph.select(graph.add(Op.OR, every, graph.add(Op.NOT, none)), -1.0, 1.0)
        return sign * graph.sqrt(squares)

    o = np.stack([np.linspace(1.2, 3.0, 40), np.full(40, 2.0), np.zeros(40)])
    d = np.repeat(np.array([[0.05], [-1.0], [0.0]]), 40, axis=1)
    truth = certify(triangle, (o, d), tolerance=1e-5, thin=1e-6)
    assert (truth.status == Status.MISS).all() and not truth.contested.any()
    inside = certify(triangle, (o - np.array([[1.0], [0.0], [0.0]]), d), tolerance=1e-5, thin=1e-6)
    assert (inside.status == Status.HIT).sum() > 10 and inside.contested.sum() <= 2
