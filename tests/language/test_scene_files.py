"""Imports and tables: what of another file is seen, and which files a scene may read."""

import os
from pathlib import Path

import pytest
from language_scenes import applied, errors, messages, scene, the

from sdfc.shape.graph import Affine, Apply, Union


def write(folder: Path, **files: str | bytes) -> None:
    for name, content in files.items():
        path = folder / name.replace("__", "/").replace("_csv", ".csv")
        path = path if path.suffix else path.with_suffix(".sdf")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())


def test_declarations_of_an_imported_file_are_visible(tmp_path: Path) -> None:
    write(tmp_path, parts="param size = 1 in 0.5..2\nmaterial gold { color: #fc0 }\ndef ball(r) = inner(r) | egg(r)\n"
          "def inner(r) = sphere(r * size).material(gold)\nfield egg(r: length) = length(p) - r * k\ndef k = 0.5\n"
          "camera { eye: [9, 9, 9] }\nscene { ball(3) }")  # fmt: skip
    made = scene('import "parts.sdf"\nscene { ball(1) | egg(1).material(gold) | sphere(size) }', tmp_path)
    assert applied(made.root).count("egg") == 1  # equal shapes are one
    assert [p.name for p in made.params] == ["size"]
    assert made.camera is None and not made.warnings
    assert made.files == (str((tmp_path / "parts.sdf").resolve()),)


def test_a_file_sees_what_it_imports_itself_and_no_more(tmp_path: Path) -> None:
    write(tmp_path, sub__deep="def deep() = sphere(1)", mid='import "sub/deep.sdf"\ndef mid() = deep()')
    assert applied(scene('import "mid.sdf"\nscene { mid() }', tmp_path).root) == ["sphere"]
    assert messages('import "mid.sdf"\nscene { deep() }', tmp_path) == ["unknown shape or function 'deep'"]


def test_a_file_imported_twice_is_read_once(tmp_path: Path) -> None:
    write(tmp_path, a="def a() = sphere(1)", b='import "a.sdf"\ndef b() = a()', c='import "a.sdf"\ndef c() = a()')
    made = scene('import "a.sdf"\nimport "b.sdf"\nimport "c.sdf"\nscene { a() | b() | c() }', tmp_path)
    assert len(made.files) == 3


def test_an_import_is_beside_the_file_that_names_it(tmp_path: Path) -> None:
    write(tmp_path, sub__one='import "two.sdf"\ndef one() = two()', sub__two='import "../top.sdf"\ndef two() = top()',
          top="def top() = box()")  # fmt: skip
    assert applied(scene('import "sub/one.sdf"\nscene { one() }', tmp_path).root) == ["box"]


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A scene's folder with links that lead out of it."""
    secret = tmp_path / "secret"
    folder = tmp_path / "scenes"
    write(secret, out="def out() = sphere(1)", table_csv="x\n1\n")
    folder.mkdir()
    os.symlink(secret / "out.sdf", folder / "link.sdf")
    os.symlink(secret, folder / "folder")
    os.symlink("loop.sdf", folder / "loop.sdf")
    os.symlink("/dev/zero", folder / "zero.sdf")
    return folder


@pytest.mark.parametrize(
    "name", ["../secret/out.sdf", "link.sdf", "folder/out.sdf", "/etc/passwd", "zero.sdf", "../../../etc/passwd"]
)
def test_no_file_outside_of_the_scenes_folder_is_read(outside: Path, name: str) -> None:
    expected = [f"'{name}' is outside of the scene's folder"]
    assert messages(f'import "{name}"\nscene {{ box() }}', outside) == expected
    assert messages(f'scene {{ instances("{name}", sphere(row.x)) }}', outside) == expected


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing.sdf", "the file 'missing.sdf' does not exist"),
        ("loop.sdf", "cannot read 'loop.sdf'"),
        ("", "this is not the name of a file"),
        (".", "the file '.' is a folder"),
        ("x" * 300 + ".sdf", "cannot read '" + "x" * 300 + ".sdf'"),
        ("x" * 2000, "this is not the name of a file"),
    ],
)
def test_a_file_that_cannot_be_read(outside: Path, name: str, message: str) -> None:
    assert messages(f'import "{name}"\nscene {{ box() }}', outside) == [message]


def test_the_nearest_name_is_offered(tmp_path: Path) -> None:
    write(tmp_path, parts="def a() = box()")
    assert errors('import "part.sdf"\nscene { box() }', tmp_path) == (
        "test.sdf:1:8: error: the file 'part.sdf' does not exist\n"
        '    1 | import "part.sdf"\n'
        "      |        ^^^^^^^^^^ did you mean 'parts.sdf'?"
    )


def test_imports_in_a_circle(tmp_path: Path) -> None:
    write(tmp_path, a='import "b.sdf"\ndef a() = box()', b='import "a.sdf"\ndef b() = box()')
    assert errors('import "a.sdf"\nscene { a() }', tmp_path) == (
        "b.sdf:1:8: error: this import closes a cycle: a.sdf → b.sdf → a.sdf\n"
        '    1 | import "a.sdf"\n'
        "      |        ^^^^^^^"
    )
    write(tmp_path, test='import "test.sdf"\nscene { box() }')
    assert messages((tmp_path / "test.sdf").read_text(), tmp_path) == [
        "this import closes a cycle: test.sdf → test.sdf"
    ]  # fmt: skip


def test_errors_in_an_imported_file_are_shown_there(tmp_path: Path) -> None:
    write(tmp_path, bad="def f( = 3\ndef g() = box()\nscene }", worse="param x = 3 in 0..1\ndef u(x) = box(x)")
    found = errors('import "bad.sdf"\nimport "worse.sdf"\nscene { sphere(-1) | u(1) }', tmp_path)
    assert [line for line in found.splitlines() if "error" in line] == [
        "bad.sdf:1:8: error: expected ')' or a name, found '='",
        "bad.sdf:3:7: error: '}' closes nothing",
        "worse.sdf:1:11: error: the default 3 is outside of 0..1",
    ]


def test_a_name_that_two_files_declare(tmp_path: Path) -> None:
    write(tmp_path, parts="def ball() = sphere(1)")
    assert errors('import "parts.sdf"\ndef ball() = box()\nscene { ball() }', tmp_path) == (
        "test.sdf:1:1: error: this file declares 'ball', which is declared already\n"
        '    1 | import "parts.sdf"\n'
        "      | ^^^^^^^^^^^^^^^^^^ it is a def at test.sdf:2:5"
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"\xff\xfe", "'bin.sdf' is not UTF-8 text"), (b"def a\0", "a NUL character: this is not a text")],
)
def test_a_file_that_is_no_text(tmp_path: Path, content: bytes, message: str) -> None:
    write(tmp_path, bin=content)
    assert messages('import "bin.sdf"\nscene { box() }', tmp_path) == [message]


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    write(tmp_path, big=b" " * (4 * 2**20 + 1))
    assert messages('import "big.sdf"\nscene { box() }', tmp_path) == ["'big.sdf' is larger than 4194304 bytes"]


def test_a_scene_without_a_file_reads_none() -> None:
    assert messages('import "a.sdf"\nscene { instances("b.csv", box()) }') == [
        "a scene without a file cannot read other files"
    ]


# --- tables

BALLS = 'scene { instances("balls.csv", sphere(radius: row.r).translate([row.x, row.y, 0]).rotate(y: row.turn)) }'


def test_instances(tmp_path: Path) -> None:
    write(tmp_path, balls_csv="x, y, r, turn\r\n0,0,0.1,30deg\n\n1.5,-2e0, 0.2 ,0.5rad\n2,0,3,0deg")
    balls = the(Union, scene(BALLS, tmp_path).root).children
    assert len(balls) == 3
    turned = the(Affine, balls[1])
    moved = the(Affine, turned.child)
    assert [e.number for e in moved.forward.offset] == [1.5, -2.0, 0.0]
    assert the(Apply, moved.child).arguments[0].number == 0.2  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("x,y,r,turn\n0,0,zero,30deg\n", "'zero' in column 'r' is not a number"),
        ("x,y,r,turn\n0,0,,30deg\n", "'' in column 'r' is not a number"),
        ("x,y,r,turn\n0,0,nan,30deg\n", "'nan' in column 'r' is not a number"),
        ("x,y,r,turn\n0,0,1e999,30deg\n", "'1e999' in column 'r' is not a number"),
        ("x,y,r,turn\n0,0,1,30grad\n", "'30grad' in column 'turn' is not a number"),
        ("x,y,r,turn\n0,0,1,30\n", "expected an angle, not a number"),
        ("x,y,r,turn\n0,0,-1,30deg\n", "radius must be greater than 0, not -1"),
        ("x,y,r,turn\n0,0,1\n", "3 cells in this row, and 4 columns"),
        ("x,y,r,r\n0,0,1,2\n", "two columns are called 'r'"),
        ("x,y,r,the turn\n0,0,1,2\n", "'the turn' is not the name of a column"),
        ("x,y,q\n0,0,1\n", "the table balls.csv has no column 'r'"),
        ("", "the table 'balls.csv' is empty"),
    ],
)
def test_a_table_that_is_wrong(tmp_path: Path, table: str, message: str) -> None:
    write(tmp_path, balls_csv=table)
    assert message in messages(BALLS, tmp_path)


def test_a_bad_cell_is_shown_in_its_table(tmp_path: Path) -> None:
    write(tmp_path, balls_csv="x,y,r,turn\n0,0,1,0deg\n0,0,one,0deg\n")
    assert errors(BALLS, tmp_path) == (
        "balls.csv:3:1: error: 'one' in column 'r' is not a number\n"
        "    3 | 0,0,one,0deg\n"
        "      | ^^^^^^^^^^^^ this is the row of the table"
    )


def test_an_error_that_a_row_makes_names_the_row(tmp_path: Path) -> None:
    write(tmp_path, balls_csv="x,y,r,turn\n0,0,1,0deg\n0,0,-1,0deg\n")
    assert errors(BALLS, tmp_path).splitlines()[-1].endswith("^^^^^ in the row at balls.csv:3:1")


def test_a_table_without_rows_makes_nothing(tmp_path: Path) -> None:
    write(tmp_path, balls_csv="x,y,r,turn\n")
    assert the(Union, scene(BALLS[:-1] + "| sphere(1) }", tmp_path).root).children != ()


def test_row_is_known_only_inside(tmp_path: Path) -> None:
    write(tmp_path, balls_csv="x\n1\n")
    assert messages('scene { instances("balls.csv", sphere(row.x)) | sphere(row.x) }', tmp_path) == [
        "'row' is known only inside instances(…)"
    ]
