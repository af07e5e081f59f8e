"""Running the command line in this process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sdfc.cli.verbs import command

SCENE = """\
param radius = 0.5 in 0.1..1.0
param turn = 0deg in 0deg..90deg
material red { color: #ff0000 }
camera { eye: [0, 0, 4], target: [0, 0, 0], fov: 40deg }
scene { sphere(radius: radius).rotate(y: turn).material(red) }
"""

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`run("check", "s.sdf")` in an empty folder that has one right scene, `s.sdf`."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.sdf").write_text(SCENE)

    def invoke(*arguments: str, stdin: str | bytes | None = None) -> Result:
        return CliRunner().invoke(command, list(arguments), input=stdin, prog_name="sdfc")

    return invoke
