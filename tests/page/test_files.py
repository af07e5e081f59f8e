"""The page's files: a table of names, small, and nobody else's business."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from devtools import Open

from sdfc import page as files

FOLDER = Path(files.__file__).parent
KINDS = {".html", ".css", ".js", ".svg"}


def test_the_table_has_every_file_and_nothing_else() -> None:
    assert set(files.FILES) == {p.name for p in FOLDER.iterdir() if p.suffix in KINDS}
    for name in files.FILES:
        assert files.content(name) == (FOLDER / name).read_bytes()
        assert len(files.content(name).splitlines()) < 400


def test_nothing_is_fetched_from_elsewhere() -> None:
    for name in files.FILES:
        addresses = set(re.findall(r"(?:https?:)?//[a-z][\w.-]+\.[a-z]+", files.content(name).decode()))
        assert addresses <= {"http://www.w3.org"}, f"{name}: {addresses}"  # the name space of SVG


def test_modules_import_files_of_the_table() -> None:
    for name in (n for n in files.FILES if n.endswith(".js")):
        text = files.content(name).decode()
        imports = set(re.findall(r'^import .* from "\./(.*)";$', text, re.MULTILINE))
        assert imports <= set(files.FILES)


@pytest.mark.gpu
def test_the_page_makes_no_globals(page: Open) -> None:
    tab = page()
    made = """(() => {
      const frame = document.body.appendChild(document.createElement("iframe"));
      const known = Object.keys(frame.contentWindow);
      frame.remove();
      return Object.keys(globalThis).filter((name) => !known.includes(name));
    })()"""
    assert tab.run(made) == []
