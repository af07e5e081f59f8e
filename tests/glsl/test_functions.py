"""The functions of definitions: those of the standard library are made once, and are the same in every scene."""

from __future__ import annotations

import pytest

import sdfc
from sdfc.field.function import Function
from sdfc.glsl import functions
from sdfc.glsl.expression import Printed

SCENE = """
param radius = 0.3 in 0.2..0.4
param p = 0.1 in 0.05..0.15
field lump(radius: length) = length(p) - radius
scene {
    box(size: [1, 1, 1]).rotate(x: 20deg)
    torus(major: radius, minor: p).translate([2, 0, 0])
    union(blend: 0.1) { sphere(radius: radius) sphere(radius: 0.2).translate([0, p, 0]) }
    lump(radius: 0.2).translate([0, p, 3])
}
"""


def texts(source: str) -> list[str]:
    compiled = sdfc.compile(source).compiled()
    return [compiled.glsl(entry) for entry in ("picture", "probe")]


def test_the_standard_library_is_printed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(functions, "_STANDARD", {})
    made: list[str] = []

    def printed(function: Function) -> Printed:
        made.append(function.name)
        return plain(function)

    plain = functions.printed
    monkeypatch.setattr(functions, "printed", printed)
    first = texts(SCENE)
    assert {"box_ray", "torus", "lump"} <= set(made)
    made.clear()
    assert texts(SCENE) == first
    assert "lump" in made and not any(name.startswith(("box", "torus", "sphere")) for name in made)


def test_no_scene_is_printed_by_what_another_one_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(functions, "_STANDARD", {})
    alone = texts(SCENE)
    other = SCENE.replace("lump", "box_2").replace("param p", "param size").replace("minor: p", "minor: size")
    for before in (other.replace(" p, ", " size, "), "scene { box(size: [1, 2, 3]) sphere(radius: 1) }"):
        monkeypatch.setattr(functions, "_STANDARD", {})
        texts(before)
        assert functions._STANDARD
        assert texts(SCENE) == alone
