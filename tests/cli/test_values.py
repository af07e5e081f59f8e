"""Values as typed."""

from __future__ import annotations

import math

import click
import pytest

from sdfc.cli.values import parse_camera, parse_settings, parse_size


def test_values_come_with_their_units() -> None:
    settings = parse_settings(["a=0.5", "b=30deg", "c=-0.5rad", "d=1,2,3", "e=[1, 2e-1, .5]", "f=true"])
    assert {name: value.numbers for name, value in settings.items()} == {
        "a": (0.5,),
        "b": (pytest.approx(math.pi / 6),),
        "c": (-0.5,),
        "d": (1.0, 2.0, 3.0),
        "e": (1.0, 0.2, 0.5),
        "f": (1.0,),
    }
    assert [value.unit for value in settings.values()] == [None, "angle", "angle", None, None, None]


def test_colours_are_made_linear() -> None:
    settings = parse_settings(["white=#ffffff", "short=#f00", "half=#808080"])
    assert settings["white"].numbers == (1.0, 1.0, 1.0)
    assert settings["short"].numbers == (1.0, 0.0, 0.0)
    assert settings["half"].numbers == pytest.approx((0.21586,) * 3, rel=1e-4)
    assert settings["half"].unit == "color"


def test_a_camera_is_one_text_or_several() -> None:
    whole = {"eye": (1.0, 2.0, 3.0), "target": (0.0, 0.0, 0.0), "fov": math.radians(35)}
    assert parse_camera(["eye=1,2,3 target=0,0,0 fov=35deg"]) == whole
    assert parse_camera(["eye=1, 2, 3; target = [0, 0, 0]", "fov=35deg"]) == whole
    assert parse_camera(["height=2"]) == {"height": 2.0}
    with pytest.raises(click.BadParameter, match="set twice"):
        parse_camera(["eye=1,2,3", "eye=1,2,3"])


@pytest.mark.parametrize("text", ["640x360", "640X360", "640,360"])
def test_sizes(text: str) -> None:
    assert parse_size(text) == (640, 360)


@pytest.mark.parametrize("text", ["", "640", "640x", "-1x5", "6.5x5", "640x360x2", "9999999999x1"])
def test_what_is_no_size(text: str) -> None:
    with pytest.raises(click.BadParameter, match="is not a size"):
        parse_size(text)
