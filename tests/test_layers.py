"""The layers of docs/architecture.md hold, and the page, the contract and the folder name the same rooms."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent


def contract_layers() -> list[set[str]]:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (layers,) = (c["layers"] for c in contracts if c["type"] == "layers")
    return [{name.strip() for name in line.split("|")} for line in layers]


def test_imports_go_one_way() -> None:
    command = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    done = subprocess.run([sys.executable, "-c", command, "--no-cache"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_architecture_page_shows_the_contract() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text()
    (block,) = re.findall(r"```layers\n(.*?)```", page, re.DOTALL)
    shown = [{n.strip() for n in line.split("#")[0].split("|")} for line in block.splitlines() if line.strip()]
    assert shown == contract_layers()


def test_the_architecture_page_names_every_room() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text()
    rooms = {p.parent.name for p in (ROOT / "sdfc").glob("*/__init__.py")} | {"grammar", "templates"}
    assert {room for room in rooms if f"`{room}/`" not in page} == set()
