"""The camera as uniforms: made in float64, relative to the scene's own origin, so that moving it never recompiles."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Protocol

from sdfc.diagnostics import scene_error
from sdfc.passes.own_origin import Frame
from sdfc.plan.setting import Setting, Vector, values_of
from sdfc.scene.model import Param, Scene


class CameraChange(Protocol):
    """What may override the scene's camera; None leaves it."""

    @property
    def eye(self) -> Vector | None: ...
    @property
    def target(self) -> Vector | None: ...
    @property
    def up(self) -> Vector | None: ...
    @property
    def fov(self) -> float | None: ...
    @property
    def height(self) -> float | None: ...


def uniforms_of(
    scene: Scene,
    setting: Setting,
    frame: Frame,
    view: CameraChange,
    params: Mapping[str, tuple[float, ...]],
    size: tuple[int, int],
    jitter: tuple[float, float],
) -> dict[str, float | tuple[float, ...]]:
    """Values for every uniform. `size` in pixels, `jitter` in pixels from the pixel's centre."""
    values = {p.name: p.default for p in scene.params} | dict(params)
    eye, axes, height = _camera(setting, view, values)
    own_eye = tuple((e - c) / frame.radius for e, c in zip(eye, frame.centre, strict=True))
    width, rows = size
    aspect = width / rows
    if height is None:
        fov = view.fov if view.fov is not None else values_of(setting.camera.fov, values)[0]
        half = math.tan(0.5 * fov)
        pixel = (0.0, half / rows, 1.0)
    else:
        half = 0.5 * height / frame.radius
        pixel = (half / rows, 0.0, 0.0)
    right, upward, ahead = axes
    uniforms: dict[str, float | tuple[float, ...]] = {
        "eye": own_eye,
        "axis_x": tuple(half * aspect * v for v in right),
        "axis_y": tuple(half * v for v in upward),
        "axis_z": ahead,
        "window": (float(width), float(rows), *jitter),
        "pixel": pixel,
        "tile_starts": 0.0,  # the texture unit of the cone prepass
    }
    for param in scene.params:
        value = values[param.name]
        uniforms[uniform_name(param)] = value if len(value) > 1 else value[0]
    return uniforms


def uniform_name(param: Param) -> str:
    """The uniform that carries a param. GLSL keeps names with two underscores in a row for itself."""
    return re.sub("_{2,}", "_", f"set_{param.name}")


def pixel_at(target: Vector, frame: Frame, uniforms: Mapping[str, float | tuple[float, ...]]) -> float:
    """How wide a pixel is at `target` (as the author wrote it), in the scene's own unit."""
    eye, pixel = uniforms["eye"], uniforms["pixel"]
    assert isinstance(eye, tuple) and isinstance(pixel, tuple)
    own = [(t - c) / frame.radius for t, c in zip(target, frame.centre, strict=True)]
    return 2.0 * (pixel[0] + pixel[1] * math.dist(eye, own))


def target_of(setting: Setting, view: CameraChange, params: Mapping[str, tuple[float, ...]]) -> Vector:
    """What the camera looks at, in the scene's units."""
    return view.target or _three(values_of(setting.camera.target, params))


def _camera(
    setting: Setting, view: CameraChange, values: Mapping[str, tuple[float, ...]]
) -> tuple[Vector, tuple[Vector, Vector, Vector], float | None]:
    """Eye, the axes (right, up, ahead), and the height where the camera is orthographic; in the scene's units."""
    camera = setting.camera
    eye = view.eye or _three(values_of(camera.eye, values))
    target = target_of(setting, view, values)
    up = view.up or _three(values_of(camera.up, values))
    height = view.height
    if height is None and camera.height is not None and view.fov is None:
        height = values_of(camera.height, values)[0]
    ahead = _unit(_minus(target, eye))
    right = _cross(ahead, up)
    if math.hypot(*ahead) == 0.0:
        raise scene_error("the camera's eye and target are the same point", None, "move one of them")
    if math.hypot(*right) < 1e-9 * math.hypot(*up):  # looking along `up`: any other direction serves
        right = _cross(ahead, (0.0, 0.0, 1.0) if abs(ahead[2]) < 0.9 else (0.0, 1.0, 0.0))
    right = _unit(right)
    return eye, (right, _cross(right, ahead), ahead), height


def _three(numbers: tuple[float, ...]) -> Vector:
    return numbers[0], numbers[1], numbers[2]


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _unit(v: Vector) -> Vector:
    size = math.hypot(*v)
    return (v[0] / size, v[1] / size, v[2] / size) if size > 0.0 else v


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
