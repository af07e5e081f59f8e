"""What is installed is what is in the folder: every package is named, every data file ships."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DATA = {"grammar": "sdfc.grammar", "templates": "sdfc.templates"}  # top-level folders that ship as packages
NOT_SHIPPED = {"__pycache__"}


def shipped_files() -> set[str]:
    """The path in the wheel of every file of `sdfc/`, `grammar/` and `templates/`."""
    found = set()
    for folder, prefix in (("sdfc", "sdfc"), ("grammar", "sdfc/grammar"), ("templates", "sdfc/templates")):
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and not NOT_SHIPPED & set(path.parts):
                found.add(f"{prefix}/{path.relative_to(ROOT / folder).as_posix()}")
    return found


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy of the sources (so that no `build/` is left in the repository)."""
    copy = tmp_path_factory.mktemp("sources")
    for folder in ("sdfc", "grammar", "templates"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns(*NOT_SHIPPED))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    command = "import setuptools.build_meta as backend; backend.build_wheel('dist')"
    subprocess.run([sys.executable, "-c", command], cwd=copy, check=True, capture_output=True)
    (built,) = (copy / "dist").glob("*.whl")
    return built


def test_every_package_is_named() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    found = {".".join(p.parent.relative_to(ROOT).parts) for p in (ROOT / "sdfc").rglob("__init__.py")}
    for folder, package in DATA.items():
        for init in (ROOT / folder).rglob("__init__.py"):
            found.add(".".join([package, *init.parent.relative_to(ROOT / folder).parts]))
    assert set(settings["packages"]) == found
    assert settings["packages"] == sorted(settings["packages"])


def test_the_wheel_holds_every_file(wheel: Path) -> None:
    names = {n for n in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in n}
    assert names == shipped_files()
    for needed in ("sdfc/grammar/scene.lark", "sdfc/py.typed"):
        assert needed in names
    assert any(n.startswith("sdfc/std/") and n.endswith(".sdf") for n in names)
    assert any(n.startswith("sdfc/templates/") and not n.endswith(".py") for n in names)


def test_the_wheel_works_from_elsewhere(wheel: Path, tmp_path: Path) -> None:
    installed = tmp_path / "installed"
    zipfile.ZipFile(wheel).extractall(installed)
    scene = tmp_path / "ball.sdf"
    scene.write_text("scene { sphere(radius: 1) }\n")
    command = "import sdfc, sys; print(sdfc.__file__, file=sys.stderr); from sdfc.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", command, "emit-glsl", str(scene)],
        cwd="/",
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert str(installed) in done.stderr
    assert "void main" in done.stdout
