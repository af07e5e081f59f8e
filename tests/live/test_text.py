"""What an edit is, told from the words of a text."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sdfc.api.request import RequestError
from sdfc.diagnostics import Source
from sdfc.live.snapshot import Edit, compare, take
from sdfc.live.text import kept, read
from sdfc.syntax import tree
from sdfc.syntax.parse import parse
from sdfc.syntax.show import _is_node

ROOT = Path(__file__).parents[2]
TEXTS = sorted([*(ROOT / "scenes").rglob("*.sdf"), *(ROOT / "sdfc" / "std").glob("*.sdf")])
SCENE = """\
import "part.sdf"
camera { eye: [0, 1, 4], target: [0, 0, 0], fov: 40deg }
light sun { direction: [-1, -2, -1] }
scene {
    ball(0.5).rotate(y: 30deg)
    instances("table.csv", sphere(radius: row.r))
}
"""


def literals_of(root: object) -> set[int]:
    """Where the parser finds numbers and colours."""
    found, stack = set(), [root]
    while stack:
        node = stack.pop()
        if isinstance(node, tree.Number | tree.Color):
            found.add(node.span.start)
        elif isinstance(node, tuple):
            stack.extend(node)
        elif _is_node(node):
            stack.extend(getattr(node, name) for name in node.__dataclass_fields__ if name != "span")
    return found


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_literals_are_those_of_the_parser(path: Path) -> None:
    text = path.read_text()
    file = parse(Source(path.name, text))
    cameras = [s for s in file.statements if isinstance(s, tree.CameraDeclaration)]
    others = tuple(s for s in file.statements if not isinstance(s, tree.CameraDeclaration))
    assert {literal.start for literal in read(text).literals} == literals_of(others)
    assert bool(read(text).camera) == bool(cameras)


@given(st.text(alphabet='ab1.0e#{}()"/*\n camera', max_size=60))
def test_any_text_has_words(text: str) -> None:
    found = read(text)
    assert [found.words[literal.word][0] for literal in found.literals] == ["<"] * len(found.literals)


@given(st.lists(st.sampled_from("abc"), max_size=12), st.lists(st.sampled_from("abc"), max_size=12))
def test_kept_words_are_equal_and_in_order(before: list[str], after: list[str]) -> None:
    pairs = kept(before, after)
    assert all(before[old] == after[new] for old, new in pairs.items())
    assert list(pairs.values()) == sorted(set(pairs.values())) or sorted(pairs) != list(pairs)
    assert [pairs[old] for old in sorted(pairs)] == sorted(set(pairs.values()))
    assert len(kept(before, before)) == len(before)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "s.sdf").write_text(SCENE)
    (tmp_path / "part.sdf").write_text("def ball(r) = sphere(radius: 2 * r)\n")
    (tmp_path / "table.csv").write_text("r\n0.1\n0.2\n")
    return tmp_path


@pytest.mark.parametrize(
    ("name", "old", "new", "edit"),
    [
        ("s.sdf", "ball(0.5)", "ball ( 0.50 ) /* a comment */", Edit()),
        ("s.sdf", "0.5", "0.6", Edit(literals=(("s.sdf", 3),))),
        ("s.sdf", "30deg", "0.6rad", Edit(literals=(("s.sdf", 4),))),
        ("s.sdf", "30deg", "30", Edit(structure=True)),
        ("s.sdf", "fov: 40deg", "fov: 2 * atan(0.3)", Edit(camera=True)),
        ("s.sdf", "eye: [0, 1, 4]", "eye: [0, 1, 5]", Edit(camera=True)),
        ("s.sdf", "ball(0.5)", "ball\n(0.5)", Edit(structure=True)),  # two words of a block
        ("s.sdf", "ball(0.5)", "ball(-0.5)", Edit(structure=True)),
        ("part.sdf", "2", "3", Edit(literals=(("part.sdf", 0),))),
        ("part.sdf", "2 * r", "r * 2", Edit(structure=True)),
        ("table.csv", "0.2", "0.3", Edit(structure=True)),
    ],
)
def test_what_an_edit_is(folder: Path, name: str, old: str, new: str, edit: Edit) -> None:
    before = take(folder / "s.sdf")
    path = folder / name
    path.write_text(path.read_text().replace(old, new))
    found = compare(before, take(folder / "s.sdf"))
    named = tuple((str(Path(source).name), index) for source, index in found.literals)
    assert (found.structure, found.camera, named) == (edit.structure, edit.camera, edit.literals)


def test_what_is_named_is_looked_at_even_if_it_is_not_there(folder: Path) -> None:
    (folder / "s.sdf").write_text(SCENE.replace("table.csv", "new/t.csv").replace("part.sdf", "../out.sdf"))
    found = take(folder / "s.sdf")
    assert folder / "new" / "t.csv" in found.looked_at
    assert found.folders == {folder}, "and nothing outside of the scene's folder"


def test_no_scene_is_the_callers_mistake(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match=r"cannot read .*none\.sdf"):
        take(tmp_path / "none.sdf")
