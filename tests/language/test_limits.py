"""What is too large, too long or too deep is told as that, soon; what is merely large works."""

import time
from collections.abc import Iterator

import pytest
from language_scenes import messages, root, scene, the

from sdfc.scene import limits
from sdfc.shape.graph import Affine, Complement, Union, topological

TOO_MANY_STEPS = ["more than 5000 calls and rounds of loops are needed to expand the scene"]
TOO_MANY_SHAPES = ["the scene has more than 1000 shapes once it is expanded"]
TOO_DEEP = ["test.sdf is nested too deeply: brackets, blocks or calls within each other"]


@pytest.fixture(autouse=True)
def soon() -> Iterator[None]:
    """Nothing here takes longer than what someone waits for (on a busy machine with two cores)."""
    begin = time.process_time()
    yield
    assert time.process_time() - begin < 20


def test_a_union_of_twenty_thousand() -> None:
    made = the(Union, root(" | ".join(f"sphere({i + 1})" for i in range(20_000))))
    assert len(made.children) == 20_000


@pytest.mark.parametrize(
    "text",
    [
        "(" * 1000 + "sphere(1)" + " | box(1))" * 1000,
        "union { " * 1000 + "sphere(1)" + " box(1) }" * 1000,
        "union(box(1), " * 1000 + "sphere(1)" + ")" * 1000,
        "union(blend: 0.1) { box(1) " * 1000 + "sphere(1)" + "}" * 1000,
        "(" * 1000 + "sphere(1)" + ".translate(x: 1) | box(1)).round(0.1)" * 1000,
        "union(for i in 0..1: " * 1000 + "sphere(1)" + ")" * 1000,
        "if true then (" * 1000 + "sphere(1)" + ") else box()" * 1000,
    ],
    ids=["parentheses", "blocks", "calls", "smooth", "chains", "loops", "conditions"],
)
def test_a_thousand_deep(text: str) -> None:
    assert root(text).dimension == 3


def test_chains_and_signs_a_thousand_long() -> None:
    assert sum(isinstance(n, Affine) for n in topological(root("sphere(1)" + ".rotate(y: 1deg)" * 1000))) == 1000
    assert sum(isinstance(n, Complement) for n in topological(root("~" * 1000 + "sphere(1)"))) == 1000


def test_functions_that_call_each_other_a_thousand_deep() -> None:
    text = "def f0() = sphere(1)\n" + "".join(f"def f{i + 1}() = f{i}() | box(1)\n" for i in range(1000))
    assert messages(text + "scene { f1000() }") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("scene { " + "~" * 200_000 + "sphere(1) }", TOO_DEEP),
        ("scene { sphere(" + "[" * 50_000 + "1" + "]" * 50_000 + ") }", TOO_DEEP),
        ("scene { for i in 0..2: " + "for j in 0..2: " * 40 + "sphere(1) | box() }", TOO_MANY_SHAPES),
        ("scene { for i in 0..2000: union(sphere(1).scale(2)) }", TOO_MANY_SHAPES),
        ("scene { sphere(sum(for i in 0..10000: sum(for j in 0..10000: 1))) }", TOO_MANY_STEPS),
        ("def f0() = sphere(1)\n" + "".join(f"def f{i + 1}() = f{i}() | f{i}()\n" for i in range(60))
         + "scene { f60() }", TOO_MANY_SHAPES),
        ("def f0(x) = x\n" + "".join(f"def f{i + 1}(x) = f{i}(x) + f{i}(x)\n" for i in range(60))
         + "scene { sphere(f60(1)) }", TOO_MANY_STEPS),
        ("field f(r: length) = sum(for i in 0..9999: sum(for j in 0..9999: p.x))\nscene { f(1) }", TOO_MANY_STEPS),
        ("scene { for i in 0..200000: box() }", ["a loop of 200000 rounds; 100000 are allowed"]),
        ("scene { for i in 0..inf: box() }", ["a loop of inf rounds; 100000 are allowed"]),
        ("scene { for i in inf..0: box() }", ["a loop of -inf rounds; 100000 are allowed"]),
        ("field f() = sum(for i in inf..0: i)\nscene { f() }", ["a loop of -inf rounds; 10000 are allowed"]),
        ("field f() = [1, 2][inf]\nscene { sphere([1, 2][inf]) }", ["index inf of a list of 2"] * 2),
        ("scene { for i in -inf..0/0: box() }", ["a loop of nan rounds; 100000 are allowed"]),
        ("scene { polygon(points: [for i in 0..1001: [i, i * i]]).extrude(1) }",
         ["points: a list of 1001 values; 1000 are allowed here"]),
        ("scene { " + "a " * 700_000 + "}", ["test.sdf is too large: more than 600000 words, numbers and signs"]),
        ("scene { " + "a" * 4_200_000 + "}", ["test.sdf is too large: 4200009 characters, and 4194304 are allowed"]),
    ],
    ids=range(17),
)  # fmt: skip
def test_limits(text: str, expected: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_STEPS", 5_000)  # a hundredth of what is allowed, to be soon done
    monkeypatch.setattr(limits, "MOST_SHAPES", 1_000)
    found = messages(text)
    assert found[: len(expected)] == expected
    assert len(found) <= 2


def test_the_limits_leave_room_for_large_scenes() -> None:
    assert limits.MOST_SHAPES >= 100_000 and limits.MOST_STEPS >= 500_000
    assert len(the(Union, root("for i in 0..10000: sphere(1).translate(x: i)")).children) == 10_000


def test_unknown_names_without_end_are_told_soon() -> None:
    assert len(messages("scene { " + " ".join(f"name{i}" for i in range(50_000)) + " }")) == 50


def test_the_recursion_limit_is_left_as_it_was() -> None:
    import sys

    before = sys.getrecursionlimit()
    scene("scene { box() }")
    assert sys.getrecursionlimit() == before
