"""Every standard solid of which a bend is known is above its parabolas: from outside, up to the first way in."""

from __future__ import annotations

import math

import numpy as np
import pytest
from standard_entries import NAMES, default_subject

from sdfc.field.bend import bend_bounds
from sdfc.field.core import signed_core
from sdfc.field.derivative import directional
from sdfc.field.numeric import Evaluator

SOLIDS = [name for name in NAMES if default_subject(name).definition.dimension == 3]
# smooth, or kinked upwards only: nothing else is needed to know how they bend
KNOWN = {"sphere", "plane", "gyroid", "schwarz_p", "displace", "waves", "paraboloid", "shear_wave", "round"}


@pytest.mark.parametrize("name", SOLIDS)
def test_a_solid_is_above_its_parabolas(name: str) -> None:
    subject = default_subject(name)
    size, core = subject.scale, signed_core(subject.formula)
    (bend,) = bend_bounds(core, [-size] * 3, [size] * 3, [{}], {})
    assert not math.isnan(bend)
    if not math.isfinite(bend):
        assert name not in KNOWN
        return
    random = np.random.default_rng(1)
    o, d = random.uniform(-size, size, (3, 2000)), random.normal(size=(3, 2000))
    d /= np.linalg.norm(d, axis=0)
    graph = core.graph
    along = directional(core, {graph.input("p"): graph.input("d")})
    value, slope = (np.broadcast_to(a, (2000,)) for a in Evaluator([core, along])({"p": o, "d": d}))
    t = np.linspace(0.0, 1.5 * size, 150)
    evaluate = Evaluator([core])
    values = np.stack([np.broadcast_to(evaluate({"p": o + x * d})[0], (2000,)) for x in t])
    within = np.stack([(np.abs(o + x * d) <= size).all(axis=0) for x in t])
    clear = np.minimum.accumulate((values > 0.0) & within, axis=0)
    assert clear.sum() > 1000
    parabola = value + slope * t[:, None] - 0.5 * bend * t[:, None] ** 2
    assert (values >= parabola - 1e-6 * size)[clear].all()
