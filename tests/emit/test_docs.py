"""What docs/emit-glsl.md shows runs as it is shown, and it tells of every target."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from emitting import ROOT

from sdfc.glsl.targets import TARGETS

PAGE = (ROOT / "docs" / "emit-glsl.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    return tmp_path


@pytest.mark.parametrize("command", "".join(blocks("sh")).splitlines())
def test_commands(command: str, folder: Path) -> None:
    arguments = shlex.split(command)
    assert arguments[0] == "sdfc"
    done = subprocess.run(
        [sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout or any(path.suffix in (".glsl", ".frag") for path in folder.iterdir())


def test_python(folder: Path) -> None:
    (text,) = blocks("python")
    done = subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "'axis_x'" in done.stdout


def test_every_target_is_told_of() -> None:
    assert [name for name in TARGETS if f"`{name}`" not in PAGE] == []
