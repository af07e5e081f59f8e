"""In a real browser the picture is the one that `sdfc render` makes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import drawn, plain, three
from emitting import IS_FULL, SCENES, program, rendered, shaders

from sdfc.api.request import View

SIZE = (160, 90)
SOME = SCENES if IS_FULL else ["csg5.sdf", "die.sdf"]

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
  const camera = new PerspectiveCamera(FOV, canvas.width / canvas.height, 0.01, 100);
  camera.position.set(...EYE);
  camera.lookAt(...TARGET);
  const scene = new Scene();
  scene.add(createMesh());
  renderer.render(scene, camera);
  return renderer.getContext();
}
"""


def assert_alike(seen: np.ndarray[Any, Any], expected: np.ndarray[Any, Any], where: np.ndarray[Any, Any]) -> None:
    off = np.abs(seen[..., :3].astype(int) - expected.astype(int)).max(axis=-1)[where]
    assert np.median(off) <= 1
    assert (off > 8).mean() < 0.01, "but for pixels of edges"


@pytest.mark.parametrize("scene", SOME)
def test_webgl(scene: str, tmp_path: Path) -> None:
    of = program(scene)
    uniforms = of.compiled().uniforms(View(), {}, SIZE)
    values = {name: value if isinstance(value, tuple) else (value,) for name, value in uniforms.items()}
    seen = drawn(tmp_path, {"draw.js": plain(of.glsl("essl300"), values)}, SIZE)
    assert_alike(seen, rendered(scene, SIZE).pixels, np.full(seen.shape[:2], True))


@pytest.mark.parametrize("scene", SOME)
def test_shadertoy(scene: str, tmp_path: Path) -> None:
    (text,) = shaders(scene, "shadertoy", "full").values()
    values = {"iResolution": (*map(float, SIZE), 1.0), "iMouse": (0.0, 0.0, 0.0, 0.0)}
    seen = drawn(tmp_path, {"draw.js": plain(text, values)}, SIZE)
    assert_alike(seen, rendered(scene, SIZE).pixels, np.full(seen.shape[:2], True))
    turned = drawn(tmp_path, {"draw.js": plain(text, values | {"iMouse": (30.0, 50.0, 1.0, 0.0)})}, SIZE)
    assert (np.abs(turned.astype(int) - seen).max(axis=-1) > 8).mean() > 0.05, "the mouse moves the eye"


def test_three(tmp_path: Path) -> None:
    (tmp_path / "three").symlink_to(three())
    camera = View(eye=(3.0, 2.4, 3.6), target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), fov=0.55)
    words = f"const EYE = {list(camera.eye)}, TARGET = {list(camera.target)}, FOV = {np.degrees(camera.fov)};\n"
    files = {"draw.js": words + THREE, "scene.js": program("csg5.sdf").glsl("three")}
    seen = drawn(tmp_path, files, SIZE)
    image = rendered("csg5.sdf", SIZE, camera=camera, aovs=("depth",))
    hit = np.isfinite(image.depth)
    assert hit.mean() > 0.1
    assert (hit != (seen[..., 3] > 128)).mean() < 0.005
    assert_alike(seen, image.pixels, hit & (seen[..., 3] > 128))
