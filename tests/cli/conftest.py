"""Running the command line in this process."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sdfc.cli.verbs import command
from sdfc.diagnostics import DeviceError
from sdfc.gpu.device import open_device

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


@pytest.fixture(scope="session")
def gl() -> None:
    """OpenGL. Without it the test is skipped, unless SDFC_REQUIRE_GL=1 says that it must be there."""
    try:
        open_device().close()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            raise
        pytest.skip(f"no OpenGL here: {error}")
