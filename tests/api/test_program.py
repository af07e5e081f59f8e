"""The Python interface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import sdfc
from sdfc.api import AOVS, RequestError, View
from sdfc.api.renderer import jitter

SCENE = """\
param radius = 0.5 in 0.1..1.0
param turn = 0deg in 0deg..90deg
camera { eye: [0, 0, 4], target: [0, 0, 0], fov: 40deg }
scene { sphere(radius: radius).rotate(y: turn) }
"""
SIZE = (24, 16)


@pytest.fixture
def program() -> Iterator[sdfc.Program]:
    """A ball, compiled."""
    with sdfc.compile(SCENE) as compiled:
        yield compiled


def test_the_package_has_its_public_names() -> None:
    assert dir(sdfc) == ["Image", "Program", "SceneError", "__version__", "compile"]
    assert all(getattr(sdfc, name) for name in sdfc.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'no_such_name'"):
        sdfc.no_such_name  # noqa: B018


def test_compile_takes_texts_paths_and_names_of_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "ball.sdf").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    glsl = sdfc.compile(SCENE).glsl()
    assert glsl.startswith("#version 450")
    assert [p.name for p in sdfc.compile("ball.sdf").params] == ["radius", "turn"]
    assert sdfc.compile(tmp_path / "ball.sdf").glsl(stage="compute") != glsl
    with pytest.raises(RequestError, match=r"cannot read 'absent\.sdf'"):
        sdfc.compile("absent.sdf")
    with pytest.raises(sdfc.SceneError):
        sdfc.compile("scene { sphere(radus: 1) }")


@pytest.mark.gpu
def test_a_render_has_every_array(program: sdfc.Program, opengl: None) -> None:
    image = program.render(SIZE)
    assert image.size == SIZE
    assert image.colour.shape == (16, 24, 3) and image.colour.dtype == np.float32
    assert set(image.aovs) == set(AOVS)
    assert image.depth[8, 12] == pytest.approx(3.5, abs=0.03) and image.depth[0, 0] == math.inf
    assert image.normal.shape == image.position.shape == (16, 24, 3)
    assert image.material.dtype == image.steps.dtype == np.int32
    assert image.materials == ("unpainted",)
    assert image.renderer


@pytest.mark.gpu
def test_an_image_that_was_not_asked_for_says_how_to_ask(program: sdfc.Program, opengl: None) -> None:
    image = program.render(SIZE, aovs=["depth"])
    with pytest.raises(AttributeError, match=r"normal was not rendered; ask for it: render\(aovs=\['normal'\]\)"):
        _ = image.normal


@pytest.mark.gpu
def test_an_image_saves_and_shows_itself(program: sdfc.Program, tmp_path: Path, opengl: None) -> None:
    image = program.render(SIZE, aovs=())
    assert image.pixels.shape == (16, 24, 3) and image.pixels.dtype == np.uint8
    image.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == image._repr_png_()
    image.save(str(tmp_path / "a.npy"))
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), image.colour)
    with pytest.raises(ValueError, match="cannot tell the format"):
        image.save(tmp_path / "a.jpg")


@pytest.mark.gpu
def test_params_are_numbers_inside_or_texts_as_typed(program: sdfc.Program, opengl: None) -> None:
    def nearest(**params: float | str) -> float:
        return float(program.render(SIZE, params=params, aovs=["depth"]).depth.min())

    assert nearest(radius=0.25) == pytest.approx(3.75, abs=0.05)
    assert nearest(radius="0.25", turn=math.pi / 4) == nearest(radius=0.25, turn="45deg")


@pytest.mark.parametrize(
    ("params", "message"),
    [
        ({"radus": 1.0}, "did you mean 'radius'"),
        ({"radius": 2.0}, r"param 'radius' = 2 is outside its range, 0\.1\.\.1"),
        ({"radius": math.nan}, "takes finite numbers"),
        ({"radius": (1.0, 2.0)}, "takes a number, not 2"),
        ({"radius": "30deg"}, "'radius' is not an angle"),
        ({"turn": "30"}, "'turn' is an angle: write 30deg or 30rad"),
        ({"turn": 2.0}, r"param 'turn' = 114\.592deg is outside its range, 0deg\.\.90deg"),
    ],
)
def test_params_are_checked(program: sdfc.Program, params: dict[str, float], message: str) -> None:
    with pytest.raises(RequestError, match=message):
        program.render(SIZE, params=params)


def test_a_view_is_checked() -> None:
    with pytest.raises(RequestError, match="eye and target are the same point"):
        View(eye=(1.0, 2.0, 3.0), target=(1.0, 2.0, 3.0))
    with pytest.raises(RequestError, match="eye takes three finite numbers"):
        View(eye=(1.0, 2.0, math.inf))


@pytest.mark.gpu
def test_progress_goes_from_nothing_to_all_over_samples_and_images(program: sdfc.Program, opengl: None) -> None:
    shares: list[float] = []
    program.render(SIZE, samples=3, aovs=["depth"], progress=shares.append)
    assert shares == pytest.approx([0.25, 0.5, 0.75, 1.0])


@pytest.mark.gpu
def test_a_closed_program_opens_another_device(program: sdfc.Program, opengl: None) -> None:
    first = program.render(SIZE).colour
    program.close()
    np.testing.assert_array_equal(program.render(SIZE).colour, first)


def test_samples_spread_over_the_pixel_the_centre_first() -> None:
    places = np.array([jitter(sample) for sample in range(64)])
    assert tuple(places[0]) == (0.0, 0.0)
    assert (abs(places) <= 0.5).all()
    counts, _, _ = np.histogram2d(places[:, 0], places[:, 1], bins=4, range=[[-0.5, 0.5]] * 2)
    assert counts.min() >= 2 and counts.max() <= 6


def test_a_pixel_that_float32_cannot_resolve_is_noted(opengl: None) -> None:
    text = """camera { eye: [0.02, 0.02, 0.04], target: [0, 0.005, 0], fov: 40deg }
    scene { sphere(radius: 0.005) box(size: [200, 400, 200]).translate([500, 0, -2000]) }"""
    notes: list[str] = []
    with sdfc.compile(text) as program:
        program.render((320, 180), note=notes.append)
        program.render((4, 3), note=notes.append, camera=View(eye=(100.0, 9000.0, 0.0)))
        program.render((4, 3), note=notes.append, backend="cpu")
    assert len(notes) == 1 and "--backend cpu" in notes[0]


def test_the_cpu_has_one_tracer_and_says_so() -> None:
    notes: list[str] = []
    with sdfc.compile("scene { sphere(radius: 1) }") as program:
        for tracer in ("auto", "proven", "relaxed:omega=1.4", "segment"):
            program.render((4, 3), note=notes.append, backend="cpu", tracer=tracer)
    assert len(notes) == 2 and "'relaxed'" in notes[0] and "'segment'" in notes[1]


def test_params_with_underscores_in_a_row_have_uniforms_that_glsl_allows(tmp_path: Path) -> None:
    text = (
        "param a__b = 0.5 in 0.2..0.8\nparam _r = 0.3 in 0.2..0.8\nscene { sphere(radius: a__b) box(size: [_r, 1, 2]) }"
    )
    with sdfc.compile(text) as program:
        glsl = program.glsl("glsl450")
        assert "set_a_b;" in glsl and "set_r;" in glsl and "__" not in glsl
        assert np.isfinite(program.render(size=SIZE, backend="cpu", params={"a__b": 0.7}).colour).all()
    with pytest.raises(sdfc.SceneError, match="params 'a__b' and 'a_b' would be one in GLSL"):
        sdfc.compile("param a__b = 0.5 in 0.1..1\nparam a_b = 0.5 in 0.1..1\nscene { sphere(radius: a__b + a_b) }")
