"""What the tests of emitted GLSL share: scenes, targets, a wrapping for each, and compilers."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from sdfc.api import Image, Program
from sdfc.api.program import compile as compile_scene
from sdfc.glsl.targets import TARGETS

ROOT = Path(__file__).parent.parent.parent
IS_FULL = os.environ.get("SDFC_FULL") == "1"
# OpenSCAD's examples, of which the repository has three: where they lie beside it, all of them are wanted too
MODELS = sorted((ROOT.parent / "shared" / "models").glob("*.csg")) if IS_FULL else []
PATHS = {p.name: p for kind in ("sdf", "csg") for p in sorted((ROOT / "scenes").glob(f"[!.]*.{kind}"))}
PATHS |= {p.name: p for p in MODELS}
SCENES = tuple(PATHS)
PARTS = ("field", "tracer", "full")
SUFFIXES = {"fragment": "frag", "compute": "comp", "vertex": "vert"}

# how a part becomes a shader: what stands in front of it
HEADS = {
    "glsl450": "#version 450 core\n",
    "glsl430": "#version 430 core\n",
    "glsl330": "#version 330 core\n",
    "essl300": "#version 300 es\n",
    "essl310": "#version 310 es\n",
    "vulkan": "#version 450\n",
    # what each site or engine puts in front itself, as far as our text needs it
    "shadertoy": "#version 300 es\nprecision highp float;\nprecision highp int;\n"
    "uniform vec3 iResolution;\nuniform vec4 iMouse;\n",
    "three": "#version 300 es\nprecision highp float;\nprecision highp int;\n",
}
TEXTUAL = tuple(HEADS)


@cache
def program(name: str) -> Program:
    """A scene of the table, compiled once."""
    return compile_scene(PATHS[name])


def rendered(name: str, size: tuple[int, int], **asked: Any) -> Image:
    """A picture by a device of its own, which is closed again: no other context is left to be current."""
    with compile_scene(PATHS[name]) as opened:
        return opened.render(size, backend="gl", **asked)


def cases() -> list[tuple[str, str]]:
    """(scene, target): all with SDFC_FULL=1, else every target on four scenes and every other scene on one."""
    every = [(scene, target) for scene in SCENES for target in TARGETS]
    if IS_FULL:
        return every
    few = ("csg5.sdf", "die.sdf", "blobs.sdf", "spheres.sdf")
    names = tuple(TARGETS)
    turns = {scene: names[i % len(names)] for i, scene in enumerate(SCENES)}
    return [(scene, target) for scene, target in every if scene in few or turns[scene] == target]


def prefix_of(scene: str) -> str:
    """What names begin with where nobody asks for anything else."""
    return scene.partition(".")[0].replace("-", "_")


def shaders(scene: str, target: str, part: str) -> dict[str, str]:
    """Complete shaders, by file name with the suffix that a validator goes by, of what was emitted."""
    row, of = TARGETS[target], program(scene)
    if part == "full":
        texts = {stage: of.glsl(target, stage) for stage in row.stages}
        if target == "shadertoy":
            ending = "out vec4 color;\nvoid main() { mainImage(color, gl_FragCoord.xy); }\n"
            texts = {"fragment": HEADS[target] + texts["fragment"] + ending}
        if target == "three":
            texts = three_stages(texts["fragment"])
        return {f"{prefix_of(scene)}.{SUFFIXES[stage]}": text for stage, text in texts.items()}
    text = of.glsl(target, part=part)
    if target == "three":
        text = quoted(text, "glsl")
    call = f"{prefix_of(scene)}_sdf(vec3(0.1))"
    if part == "tracer":
        call += f" + {prefix_of(scene)}_trace(vec3(9.0), vec3(-1.0), 0.0, 99.0).t"
    main = f"layout(location = 0) out vec4 color;\nvoid main() {{ color = vec4({call}); }}\n"
    return {f"{prefix_of(scene)}_{part}.frag": HEADS[target] + text + main}


def quoted(module: str, name: str) -> str:
    """The template literal of that name in an ES module."""
    found = re.search(rf"const {name} = /\* glsl \*/ `\n(.*?)`;", module, re.DOTALL)
    assert found, module[:500]
    return re.sub(r"\\([\\`$])", r"\1", found[1])


def three_stages(module: str) -> dict[str, str]:
    """The stages of a three.js module, with what three.js puts in front of them."""
    vertex = "uniform mat4 modelViewMatrix;\nuniform mat4 projectionMatrix;\nlayout(location = 0) in vec3 position;\n"
    return {
        "vertex": HEADS["three"] + vertex + quoted(module, "vertexShader"),
        "fragment": HEADS["three"] + quoted(module, "fragmentShader"),
    }


def tool(name: str, package: str) -> str:
    """A program of the machine; without it the test is skipped, unless SDFC_REQUIRE_GL=1."""
    path = shutil.which(name)
    if path is None:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail(f"SDFC_REQUIRE_GL=1, but {name} is not installed ({package})")
        pytest.skip(f"{name} is not installed")
    return path


def assert_valid(texts: dict[str, str], target: str, folder: Path) -> None:
    """The reference compiler takes them; for Vulkan, and spirv-val what it makes of them."""
    validator = tool("glslangValidator", "glslang-tools")
    for name, text in texts.items():
        (folder / name).write_text(text)
    commands = [[validator, *texts]]
    if target == "vulkan":
        checker = tool("spirv-val", "spirv-tools")
        commands = [
            c for name in texts for c in ([validator, "-V", name, "-o", f"{name}.spv"], [checker, f"{name}.spv"])
        ]
    for command in commands:
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert run.returncode == 0, f"{' '.join(command)}\n{run.stdout[-3000:]}{run.stderr}"
