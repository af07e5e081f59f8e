"""Names: ours and the user's never meet; and the text is GLSL for more than one compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from glsl_scenes import ENTRIES, ROOT, SMALL, compiled_file, compiled_text, template_words

from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.glsl import names
from sdfc.pipeline import Compiled
from sdfc.tracers import TRACERS

VALIDATOR = shutil.which("glslangValidator")
SUFFIXES = {"fragment": "frag", "compute": "comp", "vertex": "vert"}
SCENES = sorted(p for p in (ROOT / "scenes").iterdir() if p.suffix in (".sdf", ".csg"))


def test_every_word_of_the_templates_is_kept_from_users() -> None:
    words = template_words()
    assert {"trace", "steps", "FAR", "eye", "tolerance", "enter"} <= words
    assert words <= set(names.RESERVED), f"add to names.py _TEMPLATES: {sorted(words - set(names.RESERVED))}"


@pytest.fixture(scope="session")
def validator() -> str:
    """The reference compiler. Without it the test is skipped, unless SDFC_REQUIRE_GL=1."""
    if VALIDATOR is None:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail("SDFC_REQUIRE_GL=1, but glslangValidator is not installed (glslang-tools)")
        pytest.skip("glslangValidator is not installed")
    return VALIDATOR


def assert_valid(compiled: Compiled, validator: str, folder: Path) -> None:
    texts = {f"{entry}.{SUFFIXES[stage]}": compiled.glsl(entry, stage) for entry, stage in ENTRIES}
    texts |= {"depth.frag": compiled.glsl("depth", "fragment"), "camera.vert": compiled.vertex()}
    texts |= {f"web_{entry}.frag": compiled.web(entry) for entry in ("picture", "inspect")}
    for name, text in texts.items():
        (folder / name).write_text(text)
    run = subprocess.run([validator, *texts], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout[-3000:]


@pytest.mark.parametrize("name", SMALL)
def test_small_scenes_are_valid(name: str, validator: str, tmp_path: Path) -> None:
    for tracer in TRACERS:
        assert_valid(compiled_text(SMALL[name], tracer), validator, tmp_path)


@pytest.mark.parametrize("path", SCENES, ids=lambda p: p.name)
def test_scenes_are_valid(path: Path, validator: str, tmp_path: Path) -> None:
    assert_valid(compiled_file(path), validator, tmp_path)


# words of GLSL, of the templates, of the generated text, and of the standard library
_WORDS = """
steps box cone main ambient map trace surface march events first next near far t o d p q eps start limit count
field sphere radius eye pixel texture sample vec3 discard float live_1 solid_1 s1 s2 q_box_1 o_box_1 box_1
box_surface box_ray sphere_1 unpainted unpainted_material Surface gl_Position CENTRE travelled tau grow
bounds_1 v_torus_1 torus_1 joined_1 set_eye meet_sphere sphere_table sphere_at both inside painted
"""
WORDS = _WORDS.split()


def accepted(compiled: Compiled, renderer: GlRenderer) -> None:
    shot = Shot(compiled, View(), {}, (96, 9))
    renderer.radiance(shot, 0, None)
    assert renderer.probe(shot, None)[0].shape == (9, 96, 4)


@pytest.mark.gpu
def test_any_word_names_a_param(renderer: GlRenderer) -> None:
    usable = [w for w in WORDS if _is_a_name(f"param {w} = 0.3 in 0.1..0.5")]
    assert len(usable) > 30
    for some in (usable[i : i + 14] for i in range(0, len(usable), 14)):  # at most sixteen a scene
        text = "".join(f"param {word} = 0.3 in 0.1..0.5\n" for word in some)
        uses = " ".join(f"sphere(radius: {word}).translate([{i}, {word}, 0])" for i, word in enumerate(some))
        rest = f"torus(major: 0.7, minor: {some[0]}) rounded_box(size: [1, 1, 1], radius: {some[1]}).rotate(x: 20deg)"
        accepted(compiled_text(f"{text}scene {{ {uses} {rest} }}"), renderer)


@pytest.mark.gpu
def test_any_word_names_a_field_and_its_parameters(renderer: GlRenderer) -> None:
    usable = [w for w in WORDS if _is_a_name(f"field {w}(r: length) = length(p) - r")]
    assert len(usable) > 20
    text = "".join(f"field {w}(r: length) = length(p) - r bounds -[r, r, r] .. [r, r, r]\n" for w in usable)
    uses = " ".join(f"{w}(r: 0.3).translate([0.6 * {i}, 0, 0])" for i, w in enumerate(usable))
    accepted(compiled_text(f"{text}scene {{ {uses} }}"), renderer)
    words = [w for w in WORDS if _is_a_name(f"field ball({w}: length) = length(p) - {w}")]
    for word in words[::3]:
        field = f"field ball({word}: length) = length(p) - {word} bounds -[{word}, 1, 1] .. [{word}, 1, 1]\n"
        accepted(compiled_text(f"{field}scene {{ ball({word}: 0.4) }}"), renderer)


@pytest.mark.gpu
def test_any_word_names_a_material(renderer: GlRenderer) -> None:
    usable = [w for w in WORDS if _is_a_name(f"material {w} {{ color: #ff0000 }}")]
    assert len(usable) > 30
    text = "".join(f"material {w} {{ color: [0.0{i}, 0.5, 0.1] }}\n" for i, w in enumerate(usable))
    uses = " ".join(f"sphere(radius: 0.3).translate([{i}, 0, 0]).material({w})" for i, w in enumerate(usable[:12]))
    accepted(compiled_text(f"{text}scene {{ {uses} }}"), renderer)


def _is_a_name(declaration: str) -> bool:
    """Whether the language itself lets the word be declared (and not `t = 0.1` because of a built-in, say)."""
    from sdfc.diagnostics import SceneError

    try:
        compiled_text(f"{declaration}\nscene {{ box(size: [1, 1, 1]) }}")
    except SceneError:
        return False
    return True
