"""A solid in a box beside polygons, in one depth buffer: whoever is nearer is seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import moderngl
import numpy as np
import pytest
from emitting import prefix_of, program, rendered

from sdfc.api.request import View

SIZE = (96, 72)
Matrix = np.ndarray[Any, Any]

pytestmark = pytest.mark.gpu

POLYGON = """#version 330 core
uniform mat4 clip;
in vec3 corner;
void main() { gl_Position = clip * vec4(corner, 1.0); }
"""
RED = "#version 330 core\nout vec4 color;\nvoid main() { color = vec4(1.0, 0.0, 1.0, 1.0); }\n"


def unit(v: Matrix) -> Matrix:
    return v / np.linalg.norm(v)


def view_matrix(eye: Sequence[float], target: Sequence[float]) -> Matrix:
    ahead = unit(np.array(target, float) - np.array(eye, float))
    right = unit(np.cross(ahead, [0.0, 1.0, 0.0]))
    up = np.cross(right, ahead)
    turned = np.stack([right, up, -ahead])
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = turned, -turned @ np.array(eye, float)
    return made


def perspective(fov: float, near: float = 0.01, far: float = 100.0) -> Matrix:
    f, made = 1.0 / np.tan(0.5 * fov), np.zeros((4, 4))
    made[0, 0], made[1, 1] = f * SIZE[1] / SIZE[0], f
    made[2, 2], made[2, 3], made[3, 2] = (far + near) / (near - far), 2.0 * far * near / (near - far), -1.0
    return made


def parallel(height: float, near: float = 0.01, far: float = 100.0) -> Matrix:
    made = np.eye(4)
    made[0, 0], made[1, 1] = 2.0 * SIZE[1] / (height * SIZE[0]), 2.0 / height
    made[2, 2], made[2, 3] = -2.0 / (far - near), -(far + near) / (far - near)
    return made


def as_uniform(m: Matrix) -> bytes:
    return bytes(np.ascontiguousarray(m.T, np.float32).tobytes())


class Stage:
    """A depth buffer, and things drawn into it."""

    def __init__(self, gl: moderngl.Context, clip: Matrix) -> None:
        gl.__enter__()  # current, whatever was before: until the picture is taken
        self._gl, self._clip = gl, clip
        self._frame = gl.framebuffer([gl.texture(SIZE, 4)], gl.depth_renderbuffer(SIZE))
        self._frame.use()
        self._frame.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)

    def polygon(self, corners: Matrix) -> None:
        """A fan of corners (n, 3), magenta."""
        made = self._gl.program(vertex_shader=POLYGON, fragment_shader=RED)
        made["clip"].write(as_uniform(self._clip))
        self._gl.enable_only(moderngl.DEPTH_TEST)
        buffer = self._gl.buffer(np.asarray(corners, np.float32).tobytes())
        self._gl.vertex_array(made, [(buffer, "3f", "corner")]).render(moderngl.TRIANGLE_FAN)

    def solid(self, scene: str, move: Matrix) -> None:
        """The scene, moved: as its header says."""
        x, of = prefix_of(scene), program(scene)
        texts = {f"{stage}_shader": of.glsl("raster", stage) for stage in ("vertex", "fragment")}
        made = self._gl.program(**texts)
        matrix = self._clip @ move
        made[f"{x}_clip_from_scene"].write(as_uniform(matrix))
        made[f"{x}_scene_from_clip"].write(as_uniform(np.linalg.inv(matrix)))
        for param in of.params:
            if f"{x}_set_{param.name}" in made:
                made[f"{x}_set_{param.name}"].value = param.default[0]
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._gl.cull_face = "front"
        self._gl.vertex_array(made, []).render(moderngl.TRIANGLE_STRIP, vertices=14)

    def picture(self) -> Matrix:
        """(height, width, 4), rows from the top, 0 to 1."""
        self._gl.finish()
        self._gl.enable_only(moderngl.NOTHING)
        rows = np.frombuffer(self._frame.read(components=4), np.uint8).reshape(SIZE[1], SIZE[0], 4)
        self._gl.__exit__(None, None, None)
        return rows[::-1] / 255.0


def distance_to_plane(eye: Sequence[float], rays: Matrix, normal: Matrix, offset: float) -> Matrix:
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (offset - np.dot(eye, normal)) / (rays @ normal)
    return np.where(t > 0.0, t, np.inf)


def rays_of(eye: Sequence[float], target: Sequence[float], fov: float) -> Matrix:
    back = np.linalg.inv(view_matrix(eye, target))[:3, :3]
    half = np.tan(0.5 * fov)
    x = ((np.arange(SIZE[0]) + 0.5) / SIZE[0] * 2 - 1) * half * SIZE[0] / SIZE[1]
    y = (1 - (np.arange(SIZE[1]) + 0.5) / SIZE[1] * 2) * half
    grid = np.stack([*np.meshgrid(x, y), np.full(SIZE[::-1], -1.0)], axis=-1) @ back.T
    return grid / np.linalg.norm(grid, axis=-1, keepdims=True)


EYE, TARGET, FOV = (3.0, 2.4, 3.6), (0.0, 0.0, 0.0), 0.6
NORMAL, OFFSET = unit(np.array([0.3, 0.2, 1.0])), 0.1
SQUARE = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])


def square() -> Matrix:
    """A large square in the plane NORMAL . p = OFFSET: through the middle of the scenes."""
    u = unit(np.cross(NORMAL, [0.0, 1.0, 0.0]))
    return OFFSET * NORMAL + SQUARE[:, :1] * u + SQUARE[:, 1:] * np.cross(NORMAL, u)


@pytest.mark.parametrize("order", ["polygon first", "solid first"])
@pytest.mark.parametrize("scene", ["csg5.sdf", "chess.sdf"])
def test_the_nearer_one_is_seen(scene: str, order: str, gl: moderngl.Context) -> None:
    stage = Stage(gl, perspective(FOV) @ view_matrix(EYE, TARGET))
    if order == "polygon first":
        stage.polygon(square())
        stage.solid(scene, np.eye(4))
    else:
        stage.solid(scene, np.eye(4))
        stage.polygon(square())
    made = stage.picture()
    image = rendered(scene, SIZE, camera=View(eye=EYE, target=TARGET, up=(0, 1, 0), fov=FOV), aovs=("depth",))
    plane = distance_to_plane(EYE, rays_of(EYE, TARGET, FOV), NORMAL, OFFSET)
    solid = image.depth
    sure = np.abs(solid - plane) > 0.02
    expected = solid < plane
    is_magenta = (made[..., 0] > 0.99) & (made[..., 1] < 0.01) & (made[..., 2] > 0.99)
    assert expected.sum() > 100 and (np.isfinite(solid) & ~expected).sum() > 100, "each is in front somewhere"
    assert is_magenta[sure & ~expected & np.isfinite(plane) & (np.abs(plane) < 20)].mean() > 0.98
    wrong = sure & expected & is_magenta
    assert wrong.sum() <= 0.003 * wrong.size  # pixels of the silhouette


def test_it_looks_as_it_is_rendered(gl: moderngl.Context) -> None:
    """Also from within the box, where the front faces are behind the eye."""
    for eye, target in ((EYE, TARGET), ((0.0, 0.62, 0.0), (0.5, 0.0, 0.3))):
        stage = Stage(gl, perspective(FOV) @ view_matrix(eye, target))
        stage.solid("csg5.sdf", np.eye(4))
        made = stage.picture()
        camera = View(eye=eye, target=target, up=(0, 1, 0), fov=FOV)
        image = rendered("csg5.sdf", SIZE, camera=camera, aovs=("depth",))
        hit = np.isfinite(image.depth)
        assert (hit != (made[..., 3] > 0.5)).mean() < 0.005
        both = hit & (made[..., 3] > 0.5)
        off = np.abs(np.asarray(image.pixels)[both] / 255.0 - made[both][:, :3]).max(axis=-1)
        assert (off < 0.02).mean() > 0.99


def test_it_can_be_moved_turned_and_seen_in_parallel(gl: moderngl.Context) -> None:
    """By the matrix alone; and by parallel rays, of which a moved solid shows as the unmoved one from elsewhere."""
    turned = np.eye(4)
    turned[:3, :3] = 1.5 * np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    turned[:3, 3] = (5.0, -2.0, 1.0)
    looks = view_matrix(EYE, TARGET)
    pictures = []
    for move, view in ((np.eye(4), looks), (turned, looks @ np.linalg.inv(turned))):
        stage = Stage(gl, parallel(3.2) @ view)
        stage.solid("csg5.sdf", move)
        pictures.append(stage.picture())
    assert (pictures[0][..., 3] > 0.5).mean() > 0.1
    assert np.abs(pictures[0] - pictures[1]).max(axis=-1).mean() < 0.004
