"""The camera of the page is the renderer's: the same uniforms, the same places; and moving it keeps what it should."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from devtools import Browser, Tab
from servers import Watch

from sdfc.api.request import View
from sdfc.diagnostics import Source
from sdfc.pipeline import Options, compile_scene, load
from sdfc.scene.color import linear

SIZE = (640, 360)


def cameras(count: int, seed: int = 5) -> list[dict[str, Any]]:
    """Near and far, steep, rolled, with and without perspective; the last looks along its `up`."""
    rng = np.random.default_rng(seed)
    made = []
    for index in range(count):
        target, up = rng.normal(size=3), rng.normal(size=3)
        eye = target + rng.normal(size=3) * 10.0 ** rng.uniform(-2, 4)
        flat = index % 3 == 0
        made.append(
            {
                "eye": eye.tolist(),
                "target": target.tolist(),
                "up": up.tolist() if index % 2 else [0.0, 1.0, 0.0],
                "fov": None if flat else rng.uniform(0.1, 2.5),
                "height": rng.uniform(0.1, 20.0) if flat else None,
            }
        )
    made.append({"eye": [0.0, 4.0, 0.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "fov": 0.6, "height": None})
    return made


def view_of(camera: dict[str, Any]) -> View:
    return View(**{name: tuple(value) if isinstance(value, list) else value for name, value in camera.items()})


@pytest.fixture(scope="module")
def module(browser: Browser, watched: Watch) -> Iterator[Tab]:
    """A page whose modules can be called."""
    tab = browser.open()
    tab.go(watched.url)
    tab.until("document.readyState === 'complete'")
    yield tab
    tab.close()


def called(tab: Tab, expression: str, *arguments: Any) -> Any:
    """`expression` with the camera's module as `m` and the arguments as `a`."""
    given = json.dumps(arguments)
    return tab.run(f"import('/camera.js').then(m => {{ const a = {given}; return {expression}; }})")


def test_uniforms_are_those_of_the_compiler(module: Tab) -> None:
    text = "scene { sphere(radius: 0.7).translate([3, -2, 11]) }"
    compiled = compile_scene(load(Source("ball.sdf", text), Path()), Options())
    own = {"centre": compiled.frame.centre, "radius": compiled.frame.radius}
    known = cameras(40)
    made = called(module, "a[0].map(c => m.uniformsOf(c, a[1], a[2], [0.25, -0.125]))", known, own, SIZE)
    for camera, seen in zip(known, made, strict=True):
        expected = compiled.uniforms(view_of(camera), {}, SIZE, (0.25, -0.125))
        for name, value in seen.items():
            assert np.allclose(value, expected[name], rtol=1e-12, atol=1e-12), (name, camera)


def test_a_place_is_where_its_ray_goes(module: Tab) -> None:
    known = cameras(30)
    own = {"centre": [0, 0, 0], "radius": 1}
    at = np.random.default_rng(2).uniform(-1, 1, (len(known), 2))
    made = called(module, "a[0].map(c => m.uniformsOf(c, a[1], a[2]))", known, own, SIZE)
    points = []
    for uniforms, (x, y) in zip(made, at, strict=True):
        eye, ahead = np.array(uniforms["eye"]), np.array(uniforms["axis_z"])
        across = x * np.array(uniforms["axis_x"]) + y * np.array(uniforms["axis_y"])
        points.append((eye + 3.0 * (ahead + across) if uniforms["pixel"][2] else eye + across + 3.0 * ahead).tolist())
    seen = called(module, "a[0].map((c, i) => m.projection(c, a[1])(a[2][i]))", known, SIZE[0] / SIZE[1], points)
    for (x, y, w), expected in zip(seen, at, strict=True):
        assert w > 0
        assert np.allclose([x / w, y / w], expected, atol=1e-6)


def test_an_orbit_keeps_target_and_distance_and_can_be_undone(module: Tab) -> None:
    known = [c for c in cameras(30) if _steepness(c) < 0.9]
    assert len(known) > 10
    moved = called(module, "a[0].map(c => m.orbited(c, 0.4, 0.1))", known)
    back = called(module, "a[0].map(c => m.orbited(m.orbited(m.orbited(c, 0.4, 0), -0.1, 0), -0.3, 0))", known)
    for before, after, undone in zip(known, moved, back, strict=True):
        assert after["target"] == before["target"]
        assert math.isclose(math.dist(after["eye"], after["target"]), math.dist(before["eye"], before["target"]))
        assert math.dist(after["eye"], before["eye"]) > 0
        assert np.allclose(undone["eye"], before["eye"], rtol=1e-9)


def _steepness(camera: dict[str, Any]) -> float:
    toward, up = np.subtract(camera["eye"], camera["target"]), np.array(camera["up"])
    return float(abs(toward @ up) / np.linalg.norm(toward) / np.linalg.norm(up))


def test_an_orbit_never_goes_over_the_pole(module: Tab) -> None:
    for camera in cameras(10):
        over = called(module, "m.orbited(m.orbited(a[0], 0, 9), 0, 9)", camera)
        assert 0.99 < _steepness(over) < 1.0


def test_panning_moves_the_picture_as_far_as_the_hand(module: Tab) -> None:
    for camera in cameras(12):
        moved = called(module, "m.panned(a[0], -0.25, -0.1)", camera)
        x, y, w = called(module, "m.projection(a[0], 1)(a[1])", moved, camera["target"])
        assert np.allclose([x / w, y / w], [0.5, 0.2], atol=1e-6), "a quarter and a tenth of the picture's height"
        assert np.allclose(np.subtract(moved["eye"], moved["target"]), np.subtract(camera["eye"], camera["target"]))


def test_zooming_changes_what_is_seen_by_its_factor_and_ends_somewhere(module: Tab) -> None:
    for camera in cameras(12):
        near = called(module, "m.zoomed(a[0], 0.5, 1)", camera)
        if camera["height"] is None:
            whole = math.dist(camera["eye"], camera["target"])
            assert math.isclose(math.dist(near["eye"], near["target"]), 0.5 * whole)
        else:
            assert math.isclose(near["height"], 0.5 * camera["height"])
        for factor in ("1e-30", "1e30"):
            last = called(module, f"m.zoomed(a[0], {factor}, 1)", camera)
            assert math.isfinite(math.dist(last["eye"], last["target"])) and last["eye"] != last["target"]


def test_a_copied_camera_is_the_same_in_the_language(module: Tab) -> None:
    known = cameras(20)[:-1]
    for camera, text in zip(known, called(module, "a[0].map(c => m.textOf(c))", known), strict=True):
        scene = load(Source("copied.sdf", f"{text}\nscene {{ sphere(radius: 1) }}"), Path())
        found = scene.camera
        assert found is not None, text
        distance = math.dist(camera["eye"], camera["target"])
        assert np.allclose(found.eye.numbers, camera["eye"], atol=2e-5 * distance, rtol=0)
        assert np.allclose(found.target.numbers, camera["target"], atol=2e-5 * distance, rtol=0)
        up = np.array(camera["up"]) / np.linalg.norm(camera["up"])
        assert np.allclose(np.array(found.up.numbers) / np.linalg.norm(found.up.numbers), up, atol=1e-6)
        if camera["height"] is None:
            assert math.isclose(found.fov.number, camera["fov"], rel_tol=1e-5)
        else:
            assert found.height is not None and math.isclose(found.height.number, camera["height"], rel_tol=1e-6)


def sharp_cameras() -> list[dict[str, Any]]:
    """Zoomed in from afar, almost flat, almost all around, almost along `up`, hardly rolled."""
    made = []
    rng = np.random.default_rng(7)
    for tilt in (1.0, 1e-3):
        for turn in rng.uniform(0, 2 * math.pi, 3):
            toward = np.array([math.sin(tilt) * math.sin(turn), math.cos(tilt), math.sin(tilt) * math.cos(turn)])
            target = rng.normal(size=3)
            for distance, roll in ((1e3, 0.0), (4.0, 3e-5), (0.02, 0.0)):
                place = {
                    "eye": (target + distance * toward).tolist(),
                    "target": target.tolist(),
                    "up": [roll, 1.0, 0.0],
                }
                made += [{**place, "fov": fov, "height": None} for fov in (math.radians(1e-5), 0.6, 3.1)]
                made += [{**place, "fov": None, "height": height} for height in (1e-4, 2.0, 50.0)]
    return made


def pixels(camera: dict[str, Any], at: np.ndarray[Any, Any], rows: int = 2160) -> np.ndarray[Any, Any]:
    """(n, 2): where points are, (n, 3) in heights of the picture at the target and along `eye` to `target`."""
    eye, target = np.array(camera["eye"]), np.array(camera["target"])
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, camera["up"])
    right /= np.linalg.norm(right)
    offset = at - eye
    depth = offset @ ahead if camera["height"] is None else np.ones(len(at))
    whole = 2.0 * math.tan(0.5 * camera["fov"]) if camera["height"] is None else camera["height"]
    return rows * np.stack([offset @ right, offset @ np.cross(right, ahead)], axis=-1) / (depth * whole)[:, None]


def test_a_copied_camera_shows_the_same_to_a_hundredth_of_a_pixel(module: Tab) -> None:
    known = sharp_cameras()
    rng = np.random.default_rng(8)
    for camera, text in zip(known, called(module, "a[0].map(c => m.textOf(c))", known), strict=True):
        found = load(Source("copied.sdf", f"{text}\nscene {{ sphere(radius: 1) }}"), Path()).camera
        assert found is not None, text
        pasted = {name: getattr(found, name).numbers for name in ("eye", "target", "up")}
        pasted["fov"] = None if camera["fov"] is None else found.fov.number
        pasted["height"] = None if found.height is None else found.height.number
        assert (pasted["height"] is None) == (camera["height"] is None)
        distance = math.dist(camera["eye"], camera["target"])
        whole = camera["height"] or 2.0 * math.tan(0.5 * camera["fov"]) * distance
        at = camera["target"] + 0.3 * min(whole, distance) * rng.uniform(-1, 1, (20, 3))
        off = np.abs(pixels(camera, at) - pixels(pasted, at)).max()
        assert off < 0.01, (off, camera, text)


def test_a_copied_camera_has_the_authors_own_numbers(module: Tab) -> None:
    camera = {"eye": [2, 1.6, 3], "target": [0.1, 0, 0], "up": [0, 1, 0], "fov": math.radians(34), "height": None}
    assert called(module, "m.textOf(a[0])", camera) == "camera { eye: [2, 1.6, 3], target: [0.1, 0, 0], fov: 34deg }"


def test_colours_come_back(module: Tab) -> None:
    shown = ["#000000", "#ffffff", "#c8452f", "#0a0b0c", "#7f8081"]
    back = module.run(f"import('/colour.js').then(m => {json.dumps(shown)}.map(h => m.hexOf(m.linearOf(h))))")
    assert back == shown
    light = module.run("import('/colour.js').then(m => m.linearOf('#c8452f'))")
    assert np.allclose(light, [linear(c / 255) for c in (0xC8, 0x45, 0x2F)], rtol=1e-12)
