"""However often a scene is edited, what the driver and this process hold stays what it was.

60 edits; 5 000 with SDFC_FULL=1, which take minutes. All numbers of objects must be equal; memory may grow while caches
of a bounded size fill, and then by what allocators keep back.
"""

from __future__ import annotations

import ctypes
import gc
import os
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import moderngl
import pytest
from author import BALLS, Author

from sdfc.diagnostics import SceneError
from sdfc.gpu.program import FragmentProgram
from sdfc.live.update import Speed

pytestmark = pytest.mark.gpu

EDITS = 5_000 if os.environ.get("SDFC_FULL") == "1" else 60
MOST_GROWTH = 48 * 2**20  # bytes, from the first count on: caches of a bounded size fill
MOST_LATER = 8 * 2**20  # bytes, in the second half
SETTLING = 8  # edits of each kind before the first count: what is made once, and the shaders that are kept

SOLIDS = [
    "",
    "sphere(radius: 0.1)",
    "box(size: [0.1, 0.1, 0.1])",
    "cylinder(radius: 0.1, height: 0.1)",
    "torus(major: 0.1, minor: 0.02)",
    "capsule(from: [0, 0, 0], to: [0.1, 0.1, 0], radius: 0.05)",
]


def numbers(count: int) -> str:
    return BALLS.replace("10deg", f"{10 + 1e-3 * count:.3f}deg")


def camera(count: int) -> str:
    return BALLS.replace("eye: [0, 1, 4]", f"eye: [{1e-3 * count:.3f}, 1, 4]")


def structure(count: int) -> str:
    """Each a shader that was never seen: the digits of the count, as solids."""
    digits = [count // len(SOLIDS) ** place % len(SOLIDS) for place in range(5)]
    solids = [f"{SOLIDS[digit]}.translate([{place}, 0, 1])" for place, digit in enumerate(digits) if digit]
    return BALLS.replace("scene {", "\n    ".join(["scene {", *solids]))


def broken(count: int) -> str:
    """Unknown names, brackets that are not closed, and what only the compiler's later steps find."""
    wrong = [
        ("sphere", "spere"),
        ("fov: 40deg }", "fov: 40deg"),
        ("in 0.1..1.0", "in 0.6..1.0"),
        ("eye: [0, 1, 4]", "eye: [0, 0, 0]"),
    ]
    return numbers(count).replace(*wrong[count % len(wrong)])


KINDS: dict[str, Callable[[int], str]] = {
    "numbers": numbers,
    "camera": camera,
    "structure": structure,
    "broken": broken,
}
SHARES = {"numbers": 85, "camera": 8, "structure": 6, "broken": 1}  # of a hundred mixed edits


def mixed(seed: int) -> Iterator[str]:
    """The kinds of edits, as somebody works: mostly numbers."""
    chance = random.Random(seed)
    while True:
        yield from chance.choices(list(SHARES), list(SHARES.values()), k=100)


@dataclass(frozen=True)
class Held:
    """What there is, when nothing is being drawn."""

    wrappers: int  # moderngl's objects, and ours around them
    names: int  # the driver's
    kept: int  # programs of the session's
    memory: int  # bytes


def held(author: Author) -> Held:
    gc.collect()
    kinds = (moderngl.Program, moderngl.VertexArray, moderngl.Texture, moderngl.Framebuffer, FragmentProgram)
    found = sum(isinstance(o, kinds) for o in gc.get_objects())  # other tests' too: they stay as many
    kept = len(author.session.renderer._programs)  # type: ignore[attr-defined]
    return Held(found, names_in_use(author), kept, memory())


def memory() -> int:
    """Bytes of this process that are in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def names_in_use(author: Author) -> int:
    """How many objects the driver has. It may give each new one a new name."""
    context = author.session.renderer.device.context  # type: ignore[attr-defined]
    texture = context.texture((1, 1), 4)
    program = context.program(vertex_shader="#version 450\nvoid main() { gl_Position = vec4(0.0); }\n")
    newest = max(texture.glo, program.glo)
    texture.release()
    program.release()
    library = ctypes.CDLL("libGL.so.1")
    ask = [getattr(library, f"glIs{kind}") for kind in ("Texture", "Framebuffer", "Program", "Shader", "VertexArray")]
    return sum(bool(is_one(name) & 0xFF) for is_one in ask for name in range(1, newest + 1))


class Edits:
    """Saves one edit after another, none of them twice."""

    def __init__(self, author: Author) -> None:
        self.author = author
        self.count = 0
        self.speeds: list[Speed | None] = []  # None: told to be broken
        author.save(BALLS)

    def make(self, kind: str) -> None:
        self.count += 1
        try:
            self.speeds.append(self.author.save(KINDS[kind](self.count)).speed)
        except SceneError:
            self.speeds.append(None)


WANTED = {
    "numbers": {Speed.NUMBERS},
    "camera": {Speed.CAMERA},
    "structure": {Speed.NEW_SHADER},
    "broken": {None},
}


@pytest.mark.parametrize("kind", KINDS)
def test_edits_of_one_kind(author: Author, kind: str) -> None:
    edits = Edits(author)
    for _ in range(SETTLING):
        edits.make(kind)
    before = held(author)
    edits.speeds.clear()
    for _ in range(EDITS // 10):
        edits.make(kind)
    assert set(edits.speeds) == WANTED[kind], "they were what they are meant to be"
    check(before, held(author))


def test_edits_of_all_kinds(author: Author) -> None:
    edits = Edits(author)
    for kind in KINDS:
        for _ in range(SETTLING):
            edits.make(kind)
    start = held(author)
    kinds = mixed(seed=1)
    halves = []
    for _ in range(2):
        for _ in range(EDITS // 2):
            edits.make(next(kinds))
        halves.append(held(author))
    assert set(edits.speeds) >= {Speed.NUMBERS, Speed.CAMERA, Speed.NEW_SHADER, None}
    print(start, *halves, sep="\n")  # for those who run it with -s
    for now in halves:
        check(start, now)
    assert halves[1].memory < halves[0].memory + MOST_LATER


def check(before: Held, after: Held) -> None:
    assert (after.wrappers, after.names) == (before.wrappers, before.names)
    assert after.kept == before.kept <= 5
    assert after.memory < before.memory + MOST_GROWTH
