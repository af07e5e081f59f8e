"""In a real browser the picture is the one that `sdfc render` makes, and the field the one of float64."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from browser import Browser, browser, plain, require_three
from emitting import HEADS, IS_FULL, SCENES, prefix_of, program, quoted, rendered, shaders
from field_truth import agreement, compiled_field, points_near

from sdfc.api.request import View

__all__ = ["browser"]  # the fixture

SIZE = (160, 90)
WEB = ("essl300", "shadertoy", "three")

pytestmark = pytest.mark.gpu

THREE = """
import { PerspectiveCamera, Scene, WebGLRenderer } from "three";
import { createMesh } from "./scene.js";
export function draw(canvas) {
  const renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, preserveDrawingBuffer: true });
  renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
    throw new Error(gl.getShaderInfoLog(vertex) + gl.getShaderInfoLog(fragment) + gl.getProgramInfoLog(program));
  };
  renderer.setSize(canvas.width, canvas.height, false);
  const far = 20 * Math.hypot(...EYE.map((x, i) => x - TARGET[i]));
  const camera = new PerspectiveCamera(FOV, canvas.width / canvas.height, 1e-4 * far, far);
  camera.position.set(...EYE);
  camera.up.set(...UP);
  camera.lookAt(...TARGET);
  const scene = new Scene();
  scene.add(createMesh());
  renderer.render(scene, camera);
  return renderer.getContext();
}
"""


def sampled(*scenes: str) -> tuple[str, ...]:
    """These, or all with SDFC_FULL=1."""
    return SCENES if IS_FULL else scenes


def assert_alike(seen: np.ndarray[Any, Any], expected: np.ndarray[Any, Any], where: np.ndarray[Any, Any]) -> None:
    off = np.abs(seen[..., :3].astype(int) - expected.astype(int)).max(axis=-1)[where]
    assert np.median(off) <= 1
    assert (off > 8).mean() < 0.01, "but for pixels of edges"


@pytest.mark.parametrize("scene", sampled("csg5.sdf", "die.sdf", "heart.sdf", "csg_modules.csg"))
def test_webgl(scene: str, browser: Browser) -> None:
    of = program(scene)
    uniforms = of.compiled().uniforms(View(), {}, SIZE)
    values = {name: value if isinstance(value, tuple) else (value,) for name, value in uniforms.items()}
    seen = browser.drawn({"draw.js": plain(of.glsl("essl300"), values)}, SIZE)
    assert_alike(seen, rendered(scene, SIZE).pixels, np.full(seen.shape[:2], True))


@pytest.mark.parametrize("scene", sampled("csg5.sdf", "die.sdf", "blobs.sdf", "tower.csg"))
def test_shadertoy(scene: str, browser: Browser) -> None:
    (text,) = shaders(scene, "shadertoy", "full").values()
    values = {"iResolution": (*map(float, SIZE), 1.0), "iMouse": (0.0, 0.0, 0.0, 0.0)}
    seen = browser.drawn({"draw.js": plain(text, values)}, SIZE)
    assert_alike(seen, rendered(scene, SIZE).pixels, np.full(seen.shape[:2], True))
    turned = browser.drawn({"draw.js": plain(text, values | {"iMouse": (30.0, 50.0, 1.0, 0.0)})}, SIZE)
    assert (np.abs(turned.astype(int) - seen).max(axis=-1) > 8).mean() > 0.05, "the mouse moves the eye"


@pytest.mark.parametrize("scene", sampled("csg5.sdf", "jewel.sdf"))
def test_three(scene: str, browser: Browser) -> None:
    require_three()
    told = json.loads(program(scene).glsl("json"))
    eye, target, up = (tuple(told["camera"][name]) for name in ("eye", "target", "up"))
    half = told["camera"]["tan_half_fov"]
    words = f"const EYE = {list(eye)}, TARGET = {list(target)}, UP = {list(up)};\n"
    words += f"const FOV = {2.0 * np.degrees(np.arctan(half))};\n"
    seen = browser.drawn({"draw.js": words + THREE, "scene.js": program(scene).glsl("three")}, SIZE)
    image = rendered(scene, SIZE, aovs=("depth", "position"))
    low, high = (np.array(told["bounds"][end]) for end in ("low", "high"))
    place, margin = image.aovs["position"], 1e-3 * np.linalg.norm(high - low)
    # a floor ends at the box
    hit = np.isfinite(image.depth) & (place > low - margin).all(axis=-1) & (place < high + margin).all(axis=-1)
    shown = seen[..., 3] > 128
    assert hit.mean() > 0.02
    assert (hit & ~shown).mean() < 0.005
    if told["bounds"]["holds_everything"]:
        assert (shown & ~hit).mean() < 0.005
    assert_alike(seen, image.pixels, hit & shown)


@pytest.mark.parametrize(
    ("scene", "target"),
    [(s, t) for i, s in enumerate(SCENES) for j, t in enumerate(WEB) if IS_FULL or i % len(WEB) == j],
)
def test_fields_agree_with_float64(scene: str, target: str, browser: Browser) -> None:
    text = program(scene).glsl(target, part="field", bake=True)
    text = HEADS[target] + (quoted(text, "glsl") if target == "three" else text)
    points = points_near(compiled_field(scene), 2)
    made = browser.values(text, f"{prefix_of(scene)}_sdf(p)", points)
    assert agreement(compiled_field(scene), points, made) <= 1e-5
