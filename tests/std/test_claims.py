"""Every claim of every standard field, at random points for random arguments."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from standard_entries import NAMES, Array, Subject, default_subject, names_where, subjects

from sdfc.field.derivative import gradient
from sdfc.field.interval import IntervalEvaluator
from sdfc.field.numeric import Evaluator
from sdfc.scene.library import Library
from sdfc.shape.definition import Exactness

# SDFC_STD_EXAMPLES=200 looks harder
settings.register_profile(
    "std",
    max_examples=int(os.environ.get("SDFC_STD_EXAMPLES", "3")),
    deadline=None,
    suppress_health_check=list(HealthCheck),
    derandomize="SDFC_STD_EXAMPLES" not in os.environ,
    database=None,
)
checked = settings.get_profile("std")
_seeds = st.integers(0, 2**32 - 1)

_BOUNDED = names_where(lambda d: d.claims.exactness is not Exactness.NONE)
_CONVEX = names_where(lambda d: d.claims.convex)
_GAUGED = names_where(lambda d: d.claims.gauge is not None)
_HOMOGENEOUS = names_where(lambda d: d.claims.homogeneous)
_LOWERING = names_where(lambda d: d.claims.lowering is not None)
_DUAL = names_where(lambda d: d.claims.dual is not None)

_OUTSIDE = (Exactness.EXACT, Exactness.EXACT_OUTSIDE)
_INSIDE = (Exactness.EXACT, Exactness.EXACT_INSIDE)


def _directions(generator: np.random.Generator, size: int, count: int) -> Array:
    raw = generator.normal(size=(size, count))
    return raw / np.linalg.norm(raw, axis=0)


@pytest.mark.parametrize("name", NAMES)
def test_the_defaults_make_a_shape(name: str) -> None:
    subject = default_subject(name)
    for holds, message in subject.definition.requirements:
        assert holds(subject.arguments).numbers[0], message
    value = subject.value(subject.points(np.random.default_rng(1), 4000))
    assert np.isfinite(value).all()
    assert (value < 0).any() and (value > 0).any()
    assert subject.definition.doc.endswith(".")


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_lipschitz(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    a = np.concatenate([subject.points(generator, 700, spread) for spread in (1.1, 1.4, 12.0)], axis=1)
    near = a + _directions(generator, len(a), a.shape[1]) * subject.scale * 10.0 ** generator.uniform(
        -4, -1, a.shape[1]
    )
    far = generator.permutation(a, axis=1)
    at_a = subject.value(a)
    assert np.isfinite(at_a).all()
    for b in (near, far):
        gap = np.linalg.norm(a - b, axis=0)
        slack = 1e-10 * (subject.scale + np.linalg.norm(a, axis=0)) * max(1.0, subject.lipschitz)
        excess = np.abs(at_a - subject.value(b)) - subject.lipschitz * gap * (1 + 1e-9) - slack
        worst = int(np.argmax(excess))
        assert excess[worst] <= 0, (a[:, worst], b[:, worst], excess[worst] / gap[worst])


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_the_gradient_is_no_longer_than_lipschitz(name: str, data: st.DataObject, seed: int) -> None:
    """Climbs to where the gradient is longest: from the best points to better ones beside them, ever nearer."""
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    slope = Evaluator([gradient(subject.formula, subject.point)])
    points = np.concatenate([subject.points(generator, 400, spread) for spread in (1.2, 5.0)], axis=1)
    for step in (0.5, 0.2, 0.1, 0.03, 0.01, 0.003):
        steepness = np.linalg.norm(slope({"p": points})[0], axis=0)
        worst = int(np.argmax(steepness))
        assert steepness[worst] <= subject.lipschitz * (1 + 1e-9) + 1e-9, (points[:, worst], steepness[worst])
        best = points[:, np.argsort(steepness)[-40:]]
        moves = subject.scale * step * generator.normal(size=(len(points), 40, 5))
        points = np.concatenate([best, (best[:, :, None] + moves).reshape(len(points), -1)], axis=1)


@pytest.mark.parametrize("name", _BOUNDED)
@checked
@given(data=st.data(), seed=_seeds)
def test_no_value_is_more_than_the_distance(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name, "distance"))
    generator = np.random.default_rng(seed)
    surface = subject.surface(generator, 700)
    points = np.concatenate([subject.points(generator, 200, spread) for spread in (1.2, 4.0)], axis=1)
    if surface.shape[1] == 0:
        return
    nearest = np.min(np.linalg.norm(points[:, :, None] - surface[:, None, :], axis=0), axis=1)
    excess = np.abs(subject.value(points)) - nearest * (1 + 1e-9) - 1e-9 * subject.scale
    worst = int(np.argmax(excess))
    assert excess[worst] <= 0, (points[:, worst], excess[worst])


@pytest.mark.parametrize("name", _BOUNDED)
@checked
@given(data=st.data(), seed=_seeds)
def test_an_exact_distance_leads_to_the_surface(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name, "distance"))
    points = subject.points(np.random.default_rng(seed), 1500)
    root = subject.formula
    value, slope = Evaluator([root, gradient(root, subject.point)])({"p": points})
    right = np.zeros(len(value), bool)
    if subject.exactness in _OUTSIDE:
        right |= value > 1e-6 * subject.scale
    if subject.exactness in _INSIDE:
        right |= value < -1e-6 * subject.scale
    left = np.abs(subject.value(points - value * slope))
    worst = int(np.argmax(np.where(right, left, -1.0)))
    assert not right[worst] or left[worst] <= 1e-6 * subject.scale, (points[:, worst], value[worst], left[worst])


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_bounds_hold_every_inner_point(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    points = np.concatenate([subject.points(generator, 2000, spread) for spread in (1.05, 1.5, 4.0)], axis=1)
    value = subject.value(points)
    with_level = subject.definition.claims.bounds_use_level or subject.exactness in _OUTSIDE or subject.children
    for level in (0.0, 0.1 * subject.scale, subject.scale) if with_level else (0.0,):
        lo, hi = (corner[:, None] for corner in subject.bounds(level))
        slack = 1e-9 * subject.scale
        out = ((points < lo - slack) | (points > hi + slack)).any(axis=0)
        wrong = np.flatnonzero(out & (value <= level))
        assert len(wrong) == 0, (level, points[:, wrong[0]], value[wrong[0]])


_ENDLESS = {
    *(
        "gyroid",
        "schwarz_p",
        "diamond",
        "waves",
        "heightfield",
        "plane",
        "half_plane",
        "slab",
    ),  # whatever they are given
    *("repeat", "repeat_profile", "mirror_repeat", "mirror_repeat_in_plane"),  # a count of 0 is without end
    *("quadric", "convex_polyhedron"),  # the equation, or the planes, may be those of anything
}


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_a_solid_with_an_end_has_levels_with_an_end(name: str, data: st.DataObject, seed: int) -> None:
    """What is rounded or blended must end too, and beyond its box the field is greater, however far away."""
    subject = data.draw(subjects(name, "any", is_fenced=True))
    if not np.isfinite(subject.bounds(0.0)).all():
        assert name in _ENDLESS, "there is no end"
        return
    points = subject.scale * _directions(np.random.default_rng(seed), subject.definition.dimension, 3000)
    points *= 10.0 ** np.random.default_rng(seed).uniform(0, 6, 3000)
    value = subject.value(points)
    uses_level = subject.definition.claims.bounds_use_level or subject.exactness in _OUTSIDE or subject.children
    for level in [k * subject.scale for k in (0.0, 0.1, 1.0, 10.0) if k == 0.0 or uses_level]:
        lo, hi = (corner[:, None] for corner in subject.bounds(level))
        assert np.isfinite([lo, hi]).all(), level
        outside = ((points < lo) | (points > hi)).any(axis=0)
        assert (value[outside] > level).all()


@pytest.mark.parametrize("name", _CONVEX)
@checked
@given(data=st.data(), seed=_seeds)
def test_convex(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name, "convex"))
    generator = np.random.default_rng(seed)
    for root in {subject.formula, subject.gauge}:
        a, b = subject.points(generator, 2000, 1.2), subject.points(generator, 2000, 3.0)
        w = generator.uniform(0, 1, 2000)
        chord = (1 - w) * subject.value(a, root) + w * subject.value(b, root)
        excess = subject.value((1 - w) * a + w * b, root) - chord - 1e-9 * subject.scale
        worst = int(np.argmax(excess))
        assert excess[worst] <= 0, (a[:, worst], b[:, worst], w[worst], excess[worst])


@pytest.mark.parametrize("name", _GAUGED)
@checked
@given(data=st.data(), seed=_seeds)
def test_gauge(name: str, data: st.DataObject, seed: int) -> None:
    """The sign of the formula; and for a convex solid not more than it, so that {formula <= c} is in {gauge <= c}."""
    subject = data.draw(subjects(name))
    points = subject.points(np.random.default_rng(seed), 3000, 2.0)
    value, gauge = subject.value(points), subject.value(points, subject.gauge)
    clear = np.abs(value) > 1e-9 * subject.scale
    assert (np.sign(gauge) == np.sign(value))[clear].all()
    if subject.definition.claims.convex:
        assert (gauge <= value + 1e-9 * subject.scale)[value > 0].all()


@pytest.mark.parametrize("name", _HOMOGENEOUS)
@checked
@given(data=st.data(), seed=_seeds, factor=st.sampled_from([0.25, 3.0, 40.0]))
def test_homogeneous(name: str, data: st.DataObject, seed: int, factor: float) -> None:
    subject = data.draw(subjects(name, "distance"))
    points = subject.points(np.random.default_rng(seed), 500)
    scaled = _scaled(subject, factor)
    difference = scaled.value(points * factor) - factor * subject.value(points)
    assert np.abs(difference).max() <= 1e-8 * factor * subject.scale


def _scaled(subject: Subject, factor: float) -> Subject:
    """The same with every length times a factor, the children's also."""
    arguments = dict(subject.arguments)
    for parameter in subject.definition.values:
        given = arguments[parameter.name]
        if parameter.kind.is_length:
            arguments[parameter.name] = tuple(e * factor for e in given) if isinstance(given, tuple) else given * factor
    children = {
        name: type(child)(
            child.words,
            lambda p, child=child: child.distance(p / factor) * factor,
            lambda level, child=child: tuple(corner * factor for corner in child.box(level / factor)),
            child.exactness,
            child.convex,
            child.lipschitz,
        )
        for name, child in subject.children.items()
    }
    return Subject(subject.definition, subject.graph, arguments, children)


@pytest.mark.parametrize("name", _LOWERING)
@checked
@given(data=st.data(), seed=_seeds)
def test_lowering(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name))
    points = subject.points(np.random.default_rng(seed), 2000)
    least = np.min([subject.value(points, c.distance(subject.point)) for c in subject.children.values()], axis=0)
    assert (subject.value(points) >= least - subject.lowering - 1e-9 * subject.scale).all()


@pytest.mark.parametrize("name", _DUAL)
@checked
@given(data=st.data(), seed=_seeds)
def test_dual(name: str, data: st.DataObject, seed: int) -> None:
    subject = data.draw(subjects(name))
    dual = Library(subject.graph).definition(subject.definition.claims.dual or "")
    assert dual is not None and dual.claims.dual == name
    points = subject.points(np.random.default_rng(seed), 1000)
    negated = {n: (lambda p, c=c: -c.distance(p)) for n, c in subject.children.items()}
    value = subject.value(points, dual.formula(subject.point, subject.arguments, negated))
    assert np.abs(value + subject.value(points)).max() <= 1e-9 * subject.scale


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_derivative(name: str, data: st.DataObject, seed: int) -> None:
    """The gradient is the difference quotient, except at creases, where the one-sided quotients differ."""
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    points = subject.points(generator, 400)
    root = subject.formula
    (slope,) = Evaluator([gradient(root, subject.point)])({"p": points})
    assert np.isfinite(slope).all()
    direction = _directions(generator, len(points), points.shape[1])
    h = 1e-5 * subject.scale
    before, here, after = (subject.value(points + k * h * direction) for k in (-1, 0, 1))
    smooth = np.abs(after - 2 * here + before) < 1e-3 * h
    wrong = np.abs(np.sum(slope * direction, axis=0) - (after - before) / (2 * h)) > 2e-3 * max(1.0, subject.lipschitz)
    # one point on a crease of curvature may pass for smooth
    assert np.count_nonzero(wrong & smooth) <= 2, points[:, np.flatnonzero(wrong & smooth)[:3]]


@pytest.mark.parametrize("name", NAMES)
@checked
@given(data=st.data(), seed=_seeds)
def test_interval(name: str, data: st.DataObject, seed: int) -> None:
    """The interval over a box holds the values in it, and so does that over a piece of a ray."""
    subject = data.draw(subjects(name))
    generator = np.random.default_rng(seed)
    corner = subject.points(generator, 40)
    size = subject.scale * 10.0 ** generator.uniform(-3, 0, corner.shape)
    evaluator = IntervalEvaluator(subject.formula)
    lo, hi = evaluator.value({"p": (corner, corner + size)})
    slack = 1e-9 * subject.scale
    for _ in range(6):
        value = subject.value(corner + size * generator.uniform(0, 1, corner.shape))
        assert (value >= lo - slack).all() and (value <= hi + slack).all()
