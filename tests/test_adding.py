"""The tracer that docs/adding.md shows: two files put into a copy of the package, and it is there and right."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "adding.md").read_text()


def block(language: str) -> str:
    (text,) = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    return str(text)


@pytest.fixture
def extended(tmp_path: Path) -> Path:
    """A folder with a copy of the package, the page's tracer added."""
    ignore = shutil.ignore_patterns("__pycache__")
    package = Path(shutil.copytree(ROOT / "sdfc", tmp_path / "sdfc", ignore=ignore))
    for folder in ("grammar", "templates"):
        shutil.copytree(ROOT / folder, package / folder, ignore=ignore)
    (package / "tracers" / "hasty.py").write_text(block("python"))
    (package / "templates" / "trace" / "hasty.glsl").write_text(block("glsl"))
    return tmp_path


def sdfc(folder: Path, *arguments: str) -> str:
    command = [sys.executable, "-m", "sdfc", *arguments]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_tracer_is_two_files(extended: Path) -> None:
    assert "hasty" in sdfc(extended, "list", "tracers")
    shader = sdfc(extended, "emit-glsl", str(ROOT / "scenes" / "csg5.sdf"), "--tracer", "hasty")
    assert "over-relaxed sphere tracing (Keinert 2014)" in shader


@pytest.mark.gpu
def test_it_sees_what_proven_sees(extended: Path, gl: moderngl.Context) -> None:
    scene = str(ROOT / "scenes" / "csg5.sdf")
    depth = {}
    for tracer in ("proven", "hasty"):
        sdfc(extended, "render", scene, "--size", "64x36", "--tracer", tracer, "--aov", "depth", "-o", f"{tracer}.png")
        depth[tracer] = np.load(extended / f"{tracer}.depth.npy")
    hit = np.isfinite(depth["proven"])
    assert 0.05 < hit.mean() < 0.95
    differ = np.isfinite(depth["hasty"]) != hit
    assert differ.mean() < 0.01  # grazing rays: a tolerance of a quarter of a half pixel
    both = hit & np.isfinite(depth["hasty"])
    assert np.quantile(np.abs(depth["proven"][both] - depth["hasty"][both]), 0.98) < 0.01
