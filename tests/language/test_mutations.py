"""Whatever the text, a scene or a SceneError comes out: mutated scenes, sentences of the grammar, word soup."""

import random
import re

import pytest
from language_corpus import cases
from language_scenes import scene

from sdfc.diagnostics import SceneError, show, show_all
from sdfc.scene.library import standard_names

DIE = """
param rounding = 0.08 in 0.0..0.3
param spin = 0deg in 0deg..360deg
material gold { color: #ffcf5c, metallic: 1, roughness: 0.15 }
material tiles { color: checker(#eeeeee, #555555, scale: 0.5) }
def pip(x, y) = sphere(radius: 0.1).translate([x, y, 0.5])
def die() =
    (box(size: [1, 1, 1] - 2 * rounding).round(rounding) & sphere(radius: 0.8))
    - union(for i in 0..3: pip(0.25 * i - 0.25, 0.25 * i - 0.25))
field wave(period: length > 0, thickness: length, turns: count = 2)
    = (abs(dot(sin(q), cos(q.yzx))) * period / tau - thickness) where q = p * tau / period
    lipschitz 2 bounds -[1, 1, period]..[1, 1, 1] ray [o.x, d.y] requires period > thickness "too thick"
camera { eye: [2, 1.6, 3], target: [0, 0.5, 0], fov: 35deg }
light sun { direction: [-1, -2, -1], color: #fff4e0, intensity: 3 }
sky { zenith: #6f9fd8, horizon: #e8f0ff }
scene {
    plane(normal: [0, 1, 0]).material(tiles)
    die().rotate(y: spin).translate([0, 0.5, 0]).material(gold)
    union(blend: 0.15) { torus(major: 0.5, minor: 0.12) capsule(from: [0, 0, 0], to: [0, 1, 0], radius: 0.1) }
    (wave(period: 0.4, thickness: 0.03) & polygon(points: [for i in 0..3: [i, i * i]]).extrude(1)).scale([1, 2, 3])
}
"""
TOKEN = re.compile(r"\s+|[A-Za-z_]\w*|[\d.]+|\S")
WORDS = [
    *TOKEN.findall(DIE), *"()[]{}|&-~+*/.,:<>=!#\"", *standard_names(), "..", "for", "in", "if", "then", "else", "and",
    "or", "not", "where", "def", "import", "row", "nothing", "true", "inf", "pi", "30deg", "1e308", "1e999", "-1", "0",
    "union", "intersection", "difference", "instances", "sum", "product", "min", "count", "exact", "bound", "gauge",
    "lowering", "dual", "solid", "profile", "points2", "shear", "transform", "mirror", "level", "p", "x", "==", "<=",
]  # fmt: skip
KINDS = ["length", "numbers", "points2", "points3", "count", "angle", "boolean", "vector2", "solid", "profile"]


def mutated(rng: random.Random, text: str) -> str:
    """The text with a few tokens replaced, dropped, added, moved or repeated, or a character of any kind put in."""
    tokens = TOKEN.findall(text)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        at = rng.randrange(len(tokens)) if tokens else 0
        match rng.randrange(6):
            case 0:
                tokens[at : at + 1] = [rng.choice(WORDS)]
            case 1:
                del tokens[at : at + 1]
            case 2:
                tokens.insert(at, rng.choice(WORDS))
            case 3:
                tokens[at:at] = tokens[at - 20 : at - rng.randrange(8)]
            case 4:
                tokens[at : at + 2] = tokens[at : at + 2][::-1]
            case 5:
                tokens.insert(at, chr(rng.choice([0, 1, 9, 13, 34, 39, 92, 0x85, 0x2028, 0xFEFF, 0x1F600, 0xE9])))
    return "".join(tokens)


def expression(rng: random.Random, depth: int = 0) -> str:
    """A sentence of the grammar, of any types."""

    def inner() -> str:
        return expression(rng, depth + 1)

    leaves = ["1", "0", "x", "30deg", "pi", "inf", "true", "#f00", "[1, 2, 3]", "[0, 1]", "sphere(1)", "box()"]
    leaves += ["circle(1)", '"a"', "-1", "a", "nothing", "gold", "p", "[]"]
    if depth > 4 or rng.random() < 0.25:
        return rng.choice(leaves)
    name = rng.choice(["radius: ", "x: ", "blend: ", "", ""])
    match rng.randrange(10):
        case 0:
            return f"({inner()} {rng.choice(['+', '-', '*', '/', '|', '&', '<', '==', 'and', '..'])} {inner()})"
        case 1:
            return f"{rng.choice(WORDS)}({name}{inner()}, {inner()})"
        case 2:
            return f"{inner()}.{rng.choice(WORDS)}({name}{inner()})"
        case 3:
            return f"if {inner()} then {inner()} else {inner()}"
        case 4:
            return f"[for x in {inner()}: {inner()}]"
        case 5:
            return f"union(for x in 0..{rng.choice(['2', '1e9', '-1', '0.5', 'inf'])}: {inner()})"
        case 6:
            return f"{inner()}.{rng.choice(['x', 'xy', 'zzz', 'w', 'r', 'foo'])}"
        case 7:
            return f"union(blend: {inner()}) {{ {inner()} {inner()} }}"
        case 8:
            return f"{inner()}[{inner()}]"
    return f"{rng.choice(['-', '~', '+', 'not '])}{inner()}"


def sentence(rng: random.Random) -> str:
    claim = rng.choice(["", "exact", f"lipschitz {expression(rng, 3)}", f"ray {expression(rng, 3)}",
                        f"bounds {expression(rng, 4)}..[1, 1, 1]", f"gauge {expression(rng, 3)}"])  # fmt: skip
    return (
        f"param a = {rng.choice(['0.5', '0', '30deg', '#fff', '[1, 1]'])} in {rng.choice(['0..1', '0deg..90deg'])}\n"
        f"material gold {{ {rng.choice(['color', 'metallic', 'ior'])}: {expression(rng, 3)} }}\n"
        f"def f(x) = {expression(rng, 2)}\n"
        f"field g(x: {rng.choice(KINDS)}, s: solid) = {expression(rng, 2)} {claim}\n"
        f"camera {{ eye: {expression(rng, 4)} }}\nscene {{ {expression(rng)} f({expression(rng, 3)}) }}"
    )


def soup(rng: random.Random) -> str:
    return "scene { " + " ".join(rng.choice(WORDS) for _ in range(rng.randrange(1, 60))) + " }"


@pytest.mark.parametrize("seed", range(4))
def test_nothing_but_a_scene_error_comes_out(seed: int) -> None:
    rng = random.Random(seed)
    texts = [DIE, *[source for source, _ in cases("errors.txt")]]
    outcomes = set()
    for _ in range(500):
        text = rng.choice([lambda: mutated(rng, rng.choice(texts)), lambda: sentence(rng), lambda: soup(rng)])()
        try:
            outcomes.add(scene(text).root.dimension)
        except SceneError as error:
            assert error.diagnostics, text
            for diagnostic in error.diagnostics:
                assert show(diagnostic)
                assert diagnostic.span is None or 0 <= diagnostic.span.start <= len(diagnostic.span.source.text)
            outcomes.add(show_all(error.diagnostics).splitlines()[0])
    assert len(outcomes) > 100
