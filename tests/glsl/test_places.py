"""A part that has several places in the tree, and fields that are named as locals are: one declaration each."""

from __future__ import annotations

from pathlib import Path

import pytest
from glsl_scenes import compiled_text
from test_names_templates import assert_valid, validator

from sdfc.tracers import TRACERS

__all__ = ["validator"]

PARAM = "param a = 0.5 in 0.1..0.9\n"
FLAT = (
    "field thousandths() = 0.001 * (length(p * [1, 1.5, 2]) - 0.6) bounds -[0.61, 0.41, 0.31] .. [0.61, 0.41, 0.31]\n"
)
WAVY = "field wavy(r: length) = length(p) - r + 0.05 * sin(8 * p.x) bounds -[2, 2, 2] .. [2, 2, 2]\n"
PARTS = {
    "a rounded box": "rounded_box(size: [a * a + 1, 0.4, a * a + 1], radius: 0.1)",
    "a box": "box(size: [a * a + 1, 0.4, a * a + 1])",
    "a torus": "torus(major: a * a + 0.3, minor: a * a * 0.2 + 0.1)",
    "a superellipsoid": "superellipsoid(radii: [a * a + 0.5, 0.4, a * a + 0.5])",
    "a blend": "union(blend: a * a * 0.2) { box(size: [a * a + 1, 0.4, a * a + 1]) sphere(radius: a * a + 0.2) }",
    "a field": "wavy(r: a * a + 0.4)",
    "a flat field": "thousandths().rotate(z: 30deg).scale([1, 1, 1.4])",
}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_a_part_in_two_places_is_declared_once(part: str, validator: str, tmp_path: Path) -> None:
    """The second place reads other locals of the same values: that must not look like another part."""
    text = f"{PARAM}{FLAT}{WAVY}def t = {part}\n"
    text += "scene { (box(size: [1.4, 1.4, 0.2]) - t) | (sphere(radius: 0.55).translate([0.4, 0, 0]) - t) }"
    for tracer in TRACERS:
        assert_valid(compiled_text(text, tracer), validator, tmp_path)


@pytest.mark.parametrize("name", ["size", "opposite", "angle", "side", "cell", "ratio", "q", "d", "root", "box_2"])
def test_fields_may_be_named_as_locals_are(name: str, validator: str, tmp_path: Path) -> None:
    text = "param a = 0.5 in -0.9..0.9\n"
    text += f"field {name}(r: length = 0.4, k: vector3 = [1, 1, 1]) = length(p / (0.1 + abs(k))) - r lipschitz 12\n"
    text += f"scene {{ {name}(k: [-(a + 1), 1, -(a + 1) * 2]).translate([a * a, a * a, abs(a)]) "
    text += f"{name}(k: [abs(a), 1, abs(a)]).translate([abs(a), 3, abs(a)]) }}"
    assert_valid(compiled_text(text, "proven"), validator, tmp_path)
