"""Law: faces that coincide leave no film, no crack, no speckle. Each scene is held against one that says it simply."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from truth import Picture, Tracing, compiled_text

from sdfc.api.request import View

pytestmark = pytest.mark.gpu

SIDE = 49  # odd: the middle ray of a parallel camera lies in the planes through the middle

# Two small balls, so that both scenes of a pair have the same box, and with it the same rays.
POSTS = "sphere(radius: 0.05).translate([-2.4, -2.4, -2.4]) sphere(radius: 0.05).translate([2.4, 2.4, 2.4])"
TURN = "param turn = 0deg in -360deg..360deg\nparam tilt = 0deg in -360deg..360deg\n"


@dataclass(frozen=True, slots=True)
class Pair:
    """The same solid twice; `skin` is how far apart their surfaces may be, in units of the scene's radius."""

    name: str
    flush: str
    plain: str
    skin: float = 6e-6


BLOCK = "box(size: [1, 1, 1])"
POINTED = "cone(radius: 0.5, height: 0.6).translate([0, 0.3, 0])"
POST = "cylinder(radius: 0.5, height: 0.5).translate([0, -0.25, 0])"
BORE = "cylinder(radius: 0.3, height: {h})"
RING = "torus(major: 0.7, minor: 0.3)"
SOFT = "rounded_box(size: [1, 1, 1], radius: 0.1)"
TWISTED = f"{BLOCK}.twist(40deg)"
HALF = "box(size: [3, 1, 3]).translate([0, {y}, 0])"
SIDE_ON = "box(size: [1.5, 3, 3]).translate([{x}, 0, 0])"
CONE = "cone(radius: 0.7, height: 1)"
FLAT = "rounded_box(size: [1, 0.9, 1], radius: 0.1)"
MELTED = f"smooth_union(0.2) {{ {FLAT} sphere(radius: 0.4).translate([0.7, 0.1, 0]) }}"
ROD = "rounded_cylinder(radius: 0.3, height: 2, rounding: 0.1).rotate(x: 90deg)"
LONG = "cylinder(radius: 0.2, height: 0.5).scale([5, 1, 1])"
LINK = "link(straight: 0.6, major: 0.5, minor: 0.2)"

PAIRS = [
    Pair("box less a flush box", f"{BLOCK} - box(size: [0.4, 0.4, 1])", f"{BLOCK} - box(size: [0.4, 0.4, 3])"),
    Pair(
        "box less flush cylinders",
        f"{BLOCK} - cylinder(radius: 0.3, height: 1) - cylinder(radius: 0.2, height: 1).rotate(x: 90deg)",
        f"{BLOCK} - cylinder(radius: 0.3, height: 3) - cylinder(radius: 0.2, height: 3).rotate(x: 90deg)",
    ),
    Pair(
        "a pocket flush with the top",
        f"{BLOCK} - cylinder(radius: 0.3, height: 0.5).translate([0, 0.25, 0])",
        f"{BLOCK} - cylinder(radius: 0.3, height: 1).translate([0, 0.5, 0])",
    ),
    Pair(
        "a corner cut flush on three sides",
        f"{BLOCK} - box(size: [0.5, 0.5, 0.5]).translate([0.25, 0.25, 0.25])",
        f"{BLOCK} - box(size: [1, 1, 1]).translate([0.5, 0.5, 0.5])",
    ),
    Pair("two blocks", f"{BLOCK}.translate([-0.5, 0, 0]) | {BLOCK}.translate([0.5, 0, 0])", "box(size: [2, 1, 1])"),
    Pair(
        "three blocks",
        "box(size: [0.3, 1, 1]).translate([-0.85, 0, 0]) | box(size: [0.7, 1, 1]).translate([-0.35, 0, 0])"
        " | box(size: [1, 1, 1]).translate([0.5, 0, 0])",
        "box(size: [2, 1, 1])",
    ),
    Pair(
        "two halves of a ball",
        f"(sphere(radius: 0.8) & {HALF.format(y=0.5)}) | (sphere(radius: 0.8) - {HALF.format(y=0.5)})",
        "sphere(radius: 0.8)",
    ),
    Pair(
        "boxes that touch share nothing",
        f"{BLOCK} & {BLOCK}.translate([1, 0, 0])",
        "",
    ),
    Pair("a cylinder's end on a box", f"{BLOCK} & cylinder(radius: 0.4, height: 1).translate([0, 1, 0])", ""),
    Pair("a ball on a plane", "sphere(radius: 0.5).translate([0, 0.5, 0]) & plane()", ""),
    Pair(
        "balls that touch",
        "sphere(radius: 0.5).translate([0.5, 0, 0]) & sphere(radius: 0.8).translate([-0.8, 0, 0])",
        "",
    ),
    Pair(
        "two halves of a cone share a face",
        f"({CONE} & {HALF.format(y=0.5)}) & ({CONE} & {HALF.format(y=-0.5)})",
        "",
    ),
    Pair(
        "halves of a cone, lengthwise",
        f"({CONE} & {SIDE_ON.format(x=0.75)}) | ({CONE} & {SIDE_ON.format(x=-0.75)})",
        CONE,
    ),
    Pair("rings that touch", f"{RING}.translate([1, 0, 0]) & {RING}.translate([-1, 0, 0])", ""),
    Pair("stacked rings", f"{RING}.translate([0, 0.35, 0]) & {RING}.translate([0, -0.25, 0])", ""),
    Pair("a rod in its pipe", f"tube(outer: 0.6, inner: 0.3, height: 1) & {BORE.format(h=1)}", ""),
    Pair("a pipe in its pipe", "tube(outer: 0.6, inner: 0.4) & tube(outer: 0.4, inner: 0.2)", ""),
    Pair(
        "blocks of a row against a floor",
        f"({BLOCK}.translate([-0.5, 0.5, 0]) | {BLOCK}.translate([0.5, 0.5, 0])) & {HALF.format(y=-0.5)}",
        "",
    ),
    Pair("soft and sharp boxes that touch", f"{SOFT} & {BLOCK}.translate([1, 0, 0])", ""),
    Pair("three boxes of which two touch", f"{BLOCK} & {BLOCK}.translate([1, 0, 0]) & sphere(radius: 0.7)", ""),
    Pair(
        "a soft box and a ball on a sharp one",
        f"({SOFT}.translate([0, 0.5, 0]) | sphere(radius: 0.4).translate([0.9, 0.4, 0])) & {HALF.format(y=-0.5)}",
        "",
    ),
    Pair(
        "what a stretched part touches",
        f"{BLOCK}.translate([0, 0.5, 0]) & cylinder(radius: 0.2, height: 1).translate([0, -0.5, 0]).scale([8, 1, 1])",
        "",
    ),
    Pair(
        "what a stretched part touches with its steep side",
        f"{BLOCK}.translate([-0.5, 0, 0]) & {LONG}.translate([1, 0, 0])",
        "",
    ),
    Pair("a stretched part less a box over half of it", f"{LONG} & {BLOCK} - {BLOCK}", ""),
    Pair(
        "half of a stretched part less the same half",
        f"({LONG} - {SIDE_ON.format(x=0.75)}) - {SIDE_ON.format(x=-0.75)}",
        "",
    ),
    Pair("a stretched part less the box around it", f"{LONG} - box(size: [2, 0.5, 0.4])", ""),
    Pair(
        "halves of a stretched part",
        f"({LONG} & {SIDE_ON.format(x=0.75)}) | ({LONG} & {SIDE_ON.format(x=-0.75)})",
        LONG,
    ),
    Pair("a box less itself", f"{BLOCK} - {BLOCK}", ""),
    Pair("a box less two halves of it", f"{BLOCK} - {HALF.format(y=0.5)} - {HALF.format(y=-0.5)}", ""),
    Pair(
        "what is left of a cut",
        f"{BLOCK} - ({BLOCK} - sphere(radius: 0.6))",
        f"{BLOCK} & sphere(radius: 0.6)",
    ),
    Pair(
        "a cylinder flush with a ball's equator",
        f"(sphere(radius: 0.5) - {HALF.format(y=0.5)}) | cylinder(radius: 0.5, height: 0.7).translate([0, 0.35, 0])",
        "sphere(radius: 0.5) | cylinder(radius: 0.5, height: 0.7).translate([0, 0.35, 0])",
    ),
    Pair(
        "a cone whose base is the end of a cylinder",
        f"{POINTED} | {POST}",
        f"{POINTED} | {POST} | cylinder(radius: 0.4, height: 0.2)",
    ),
    Pair("soft box, flush hole", f"{SOFT} - {BORE.format(h=1)}", f"{SOFT} - {BORE.format(h=3)}"),
    Pair(
        "twisted box, flush hole",
        f"{TWISTED} - cylinder(radius: 0.3, height: 1)",
        f"{TWISTED} - cylinder(radius: 0.3, height: 3)",
    ),
    Pair(
        "halves of a torus",
        f"({RING} & {HALF.format(y=0.5)}) | ({RING} - {HALF.format(y=0.5)})",
        RING,
        1e-4,
    ),
    Pair(
        "halves of a link",
        f"({LINK} & {HALF.format(y=0.5)}) | ({LINK} - {HALF.format(y=0.5)})",
        LINK,
        1e-4,
    ),
    Pair(
        "halves of a blend",
        f"({MELTED} & {HALF.format(y=0.6)}) | ({MELTED} - {HALF.format(y=0.6)})",
        MELTED,
        1e-4,
    ),
    Pair(
        "two blocks, each less the same soft rod",
        f"({BLOCK}.translate([-0.5, 0, 0]) - {ROD}) | ({BLOCK}.translate([0.5, 0, 0]) - {ROD})",
        f"box(size: [2, 1, 1]) - {ROD}",
        3e-5,
    ),
    Pair(
        "thirds of a soft box",
        f"({FLAT} & {SIDE_ON.format(x=-0.95)}) | ({FLAT} & box(size: [0.4, 3, 3]))"
        f" | ({FLAT} & {SIDE_ON.format(x=0.95)})",
        FLAT,
        1e-4,
    ),
    Pair(
        "thirds of a bent bar",
        f"({TWISTED} & {HALF.format(y=0.6)}) | ({TWISTED} - {HALF.format(y=0.6)} - {HALF.format(y=-0.6)})"
        f" | ({TWISTED} & {HALF.format(y=-0.6)})",
        TWISTED,
        1e-4,
    ),
    Pair(
        "a ring less what lies flush on it",
        "torus(major: 0.7, minor: 0.3) - box(size: [3, 0.3, 3]).translate([0, 0.15, 0])",
        "torus(major: 0.7, minor: 0.3) - box(size: [3, 1, 3]).translate([0, 0.5, 0])",
    ),
    Pair(
        "a box less a soft plug of its own height",
        f"{BLOCK} - rounded_cylinder(radius: 0.3, height: 1, rounding: 0)",
        f"{BLOCK} - cylinder(radius: 0.3, height: 3)",
        3e-5,
    ),
]


def scene(solid: str) -> str:
    turned = f"union {{ {solid} }}.rotate(y: turn).rotate(z: tilt)" if solid else ""
    return f"{TURN}scene {{ {turned} {POSTS} }}"


def views() -> dict[str, View]:
    """Cameras: with perspective, parallel, along the axes, and grazing."""
    origin, up = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    return {
        "corner": View(eye=(3.1, 2.2, 3.7), target=origin, up=up, fov=0.7),
        "below": View(eye=(-2.3, -3.2, 1.7), target=origin, up=up, fov=0.7),
        "along z": View(eye=(0.0, 0.0, 4.0), target=origin, up=up, fov=0.7),
        "parallel": View(eye=(2.0, 3.0, 4.0), target=origin, up=up, height=3.0),
        "parallel to z": View(eye=(0.0, 0.0, 4.0), target=origin, up=up, height=2.4),
        "parallel to y": View(eye=(0.0, 4.0, 0.0), target=origin, up=(0.0, 0.0, -1.0), height=2.4),
        "grazing": View(eye=(4.0, 0.5, 0.03), target=(0.0, 0.5, 0.0), up=up, fov=0.5),
        "almost grazing": View(eye=(4.0, 0.52, 0.7), target=(0.0, 0.48, 0.0), up=up, fov=0.5),
    }


def neighbours(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """A picture (..., SIDE, SIDE) moved to each of its eight neighbours; the edge repeated."""
    padded = np.pad(values, [(0, 0)] * (values.ndim - 2) + [(1, 1), (1, 1)], mode="edge")
    steps = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    return [padded[..., i : i + SIDE, j : j + SIDE] for i, j in steps]


def assert_same(flush: Picture, plain: Picture, skin: float) -> None:
    """Where the simple scene shows one smooth face, or nothing, all around a pixel, both show the same."""
    assert (flush.d == plain.d).all() and (flush.o == plain.o).all(), "the scenes' boxes differ, and so the rays"
    hit = plain.hit.reshape(SIDE, SIDE)
    normal = plain.normal.reshape(3, SIDE, SIDE)
    near_hits = [n > 0.5 for n in neighbours(hit.astype(float))]
    alike = [(n * normal).sum(axis=0) > 0.9 for n in neighbours(normal)]
    face = (hit & np.all(near_hits, axis=0) & np.all(alike, axis=0)).ravel()
    void = (~hit & ~np.any(near_hits, axis=0)).ravel()
    holes, films = (face & ~flush.hit).sum(), (void & flush.hit).sum()
    assert (holes, films) == (0, 0), f"{holes} holes in {face.sum()} pixels of faces, {films} specks in {void.sum()}"
    edge = ~face & ~void
    assert (edge & (flush.hit != plain.hit)).sum() <= max(2, 0.05 * edge.sum()), "the edges differ"
    seen = face & flush.hit
    steep = np.maximum(np.abs((plain.normal * plain.d).sum(axis=0)), 0.02)
    off = np.abs(flush.depth - plain.depth)[seen] * steep[seen]
    assert off.size == 0 or off.max() < skin, f"a face is off by {off.max():.1e}"
    turned = (flush.normal * plain.normal).sum(axis=0)[seen]
    assert turned.size == 0 or turned.min() > 0.999, f"{(turned < 0.999).sum()} of {turned.size} normals are wrong"


@pytest.mark.parametrize("pair", PAIRS, ids=[p.name for p in PAIRS])
def test_coincident_faces(pair: Pair, tracing: Tracing, is_full: bool) -> None:
    flush, plain = (compiled_text(scene(s)) for s in (pair.flush, pair.plain))
    turns = [(0.0, 0.0), (90.0, 0.0), (37.0, 0.0), (45.0, 45.0), (0.3, 0.0), (179.0, 61.0)]
    turns += [(360.0 * i / 36, 77.7 * i % 360) for i in range(36)] if is_full else []
    failures = []
    for turn, tilt in turns:
        params = {"turn": (math.radians(turn),), "tilt": (math.radians(tilt),)}
        for name, view in views().items():
            pictures = (tracing.picture(c, (SIDE, SIDE), view, params) for c in (flush, plain))
            try:
                assert_same(*pictures, pair.skin)
            except AssertionError as error:
                failures.append(f"turn {turn}, tilt {tilt}, {name}: {' '.join(str(error).split())[:110]}")
    assert not failures, "\n".join(failures)


@pytest.mark.parametrize("factor", [0.01, 100.0])
def test_the_size_of_the_scene_does_not_matter(factor: float, tracing: Tracing) -> None:
    pair = PAIRS[1]

    def scaled(solid: str) -> str:
        return f"scene {{ union {{ union {{ {solid} }}.rotate(x: 23deg) {POSTS} }}.scale({factor}) }}"

    flush, plain = (compiled_text(scaled(s)) for s in (pair.flush, pair.plain))
    for turn in range(0, 360, 40):
        eye = tuple(4.5 * factor * v for v in (math.cos(turn), 0.4, math.sin(turn)))
        view = View(eye=(eye[0], eye[1], eye[2]), target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), fov=0.7)
        assert_same(*(tracing.picture(c, (SIDE, SIDE), view) for c in (flush, plain)), pair.skin)


def test_a_ray_along_the_line_where_four_parts_meet(tracing: Tracing) -> None:
    quarters = (
        f"sphere(radius: 0.8) & {HALF.format(y=y)} & {SIDE_ON.format(x=x)}" for x in (-0.75, 0.75) for y in (-0.5, 0.5)
    )
    flush, plain = (
        compiled_text(f"scene {{ {solid} {POSTS} }}") for solid in (" | ".join(quarters), "sphere(radius: 0.8)")
    )
    for view in views().values():
        assert_same(*(tracing.picture(c, (SIDE, SIDE), view) for c in (flush, plain)), 6e-6)
