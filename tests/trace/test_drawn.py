"""Law: a ray along the walls of a profile that is drawn out takes few steps, however near the wall, and misses nothing.

The truth is a twin of boxes, in closed form: the answer is no earlier than with them grown by a tolerance, and no later
than with them shrunk by it.
"""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest
from aimed import Array, aim, compiled, own

from sdfc.pipeline import Compiled
from sdfc.plan.steps import Ball, leaves_of
from sdfc.reference.formulas import Formulas
from sdfc.reference.rays import Rays
from sdfc.reference.trace import StepTracer
from sdfc.shape.lower import FAR

HEIGHT = 0.6
CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.0], [0.0, 0.0], [0.0, 0.5], [-0.5, 0.5]])
POINTS = ", ".join(f"[{x}, {y}]" for x, y in CORNERS)
ANGLE = f"polygon(points: [{POINTS}])"
CONE = (0.0, 1e-8)  # the tolerance is the least there is
SLACK = 1e-5
MOST = 64

_C, _S = np.cos(np.radians(30.0)), np.sin(np.radians(30.0))
_TURN = np.array([[1.0, 0.0, 0.0], [0.0, _C, -_S], [0.0, _S, _C]])
PLACES = {  # how it is placed and cut, and the matrix of it
    "as it is": ("", "", np.eye(3)),
    "turned and scaled": (".rotate(x: 30deg).scale(1.7)", "", 1.7 * _TURN),
    "stretched": (".rotate(x: 30deg).scale([1, 2, 0.5])", "", np.diag([1.0, 2.0, 0.5]) @ _TURN),
    "cut": ("", " & sphere(radius: 2)", np.eye(3)),
    "cut at an end": ("", " & box(size: [2, 2, 0.6])", np.eye(3)),
    "turned and cut": (".rotate(x: 30deg)", " - sphere(radius: 0.1)", _TURN),
}


def boxes(grown: float) -> str:
    """The profile drawn out, as a union of two boxes."""
    sides = [((-0.5, -0.5), (0.5, 0.0)), ((-0.5, -0.5), (0.0, 0.5))]
    made = []
    for (left, bottom), (right, top) in sides:
        size = [right - left + 2 * grown, top - bottom + 2 * grown, HEIGHT + 2 * grown]
        made.append(f"box(size: {size}).translate([{(left + right) / 2}, {(bottom + top) / 2}, 0])")
    return f"({' | '.join(made)})"


def along_walls(seed: int, count: int) -> tuple[Array, Array]:
    """Rays (3, count) down past the walls: 1e-1 to 1e-6 beside them, tilted by some times as much, or not at all."""
    random = np.random.default_rng(seed)
    edge = random.integers(0, len(CORNERS), count)
    first, second = CORNERS[edge], CORNERS[(edge + 1) % len(CORNERS)]
    way = (second - first) / np.linalg.norm(second - first, axis=1)[:, None]
    off = 10.0 ** -random.uniform(1.0, 6.0, count)[:, None]
    place = first + random.uniform(0.0, 1.0, (count, 1)) * (second - first)
    place = place + off * np.stack([way[:, 1], -way[:, 0]], axis=1)
    tilt = random.normal(size=(count, 2)) * off * random.choice([0.0, 0.3, 3.0], (count, 1))
    o = np.concatenate([place, np.full((count, 1), HEIGHT / 2 + 0.4)], axis=1)
    d = np.concatenate([tilt, np.full((count, 1), -1.0)], axis=1)
    return o.T, d.T


def twin(scene: Compiled, o: Array, d: Array) -> tuple[Array, Array]:
    """How far (in the scene's lengths; FAR for a miss) the float64 tracer goes, and its steps, (n,) each."""
    formulas = Formulas(scene.scene.values, {}, scene.plan.materials, scene.setting.unpainted)
    mine, way = own(scene, o, d)
    count = o.shape[1]
    rays = Rays(mine, way, np.zeros(count), CONE)
    found, steps = StepTracer(scene.plan, formulas).first(rays, np.zeros(count), np.full(count, FAR))
    return np.where(found < FAR, found * scene.frame.radius, FAR), steps


def bracketed(found: Array, o: Array, d: Array, place: str, cut: str) -> None:
    """No earlier than the truth, and no later."""
    early, late = (
        twin(compiled(f"scene {{ {boxes(grown)}{place}{cut} }}", "proven"), o, d)[0] for grown in (SLACK, -SLACK)
    )
    assert (early < FAR).any() and (late >= FAR).any()
    room = 1e-4  # of a wall that a ray meets at a small angle: along the ray
    assert not (found < early - room).any(), "something invented"
    assert not (found > late + room).any(), "something missed"


@pytest.mark.gpu
@pytest.mark.parametrize("name", PLACES)
def test_rays_along_walls(name: str, gl: moderngl.Context) -> None:
    place, cut, matrix = PLACES[name]
    scene = compiled(f"scene {{ {ANGLE}.extrude(height: {HEIGHT}){place}{cut} }}", "proven")
    assert any(isinstance(leaf, Ball) and leaf.drawn is not None for leaf in leaves_of(scene.plan.root))
    o, d = along_walls(3, 3000)
    o, d = matrix @ o, matrix @ d
    found, steps = twin(scene, o, d)
    assert steps.max() <= MOST, f"the float64 twin takes {steps.max():g}"
    bracketed(found, o, d, place, cut)
    mine, way = (a.astype(np.float32).astype(float) for a in own(scene, o, d))
    seen = aim(gl, scene, mine, way, cone=CONE)
    assert not seen.unfinished.any() and seen.evaluations.max() <= MOST, f"{seen.evaluations.max():g} steps"
    centre = np.array(scene.frame.centre)[:, None]
    bracketed(np.where(seen.hit, seen.t * scene.frame.radius, FAR), mine * scene.frame.radius + centre, way, place, cut)


@pytest.mark.parametrize("solid", ["star().extrude(height: 0.5)", "star().extrude_rounded(height: 0.5, radius: 0.04)"])
def test_what_plain_balls_find(solid: str) -> None:
    """Where they end: any rays, of which most do not run along a wall."""
    scene = compiled(f"scene {{ {solid}.rotate(x: 20deg) }}", "proven")
    (leaf,) = leaves_of(scene.plan.root)
    assert isinstance(leaf, Ball) and leaf.drawn is not None
    plain = replace(scene, plan=replace(scene.plan, root=replace(leaf, drawn=None)))
    random = np.random.default_rng(5)
    o = random.normal(size=(3, 4000))
    o *= 2.0 / np.linalg.norm(o, axis=0)
    d = random.uniform(-0.5, 0.5, o.shape) - o
    (found, steps), (balls, most) = twin(scene, o, d), twin(plain, o, d)
    done = most < 500
    assert done.mean() > 0.99 and steps.sum() < most.sum()
    assert ((found < FAR) == (balls < FAR))[done].mean() > 0.999
    both = done & (found < FAR) & (balls < FAR)
    assert np.median(np.abs(found - balls)[both]) < 1e-6 and (np.abs(found - balls)[both] < 1e-3).mean() > 0.995
