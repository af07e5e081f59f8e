"""Drawing programs into frames."""

from __future__ import annotations

import numpy as np
import pytest

from sdfc.diagnostics import DeviceError, InternalError
from sdfc.gpu.device import Device
from sdfc.gpu.examine import examine
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram, ShaderRefusedError, parse_complaints

pytestmark = pytest.mark.gpu

HEAD = "#version 450 core\nlayout(location = 0) out vec4 first;\n"
COORDINATES = HEAD + "void main() { first = vec4(gl_FragCoord.xy, 0.0, 1.0); }\n"


def test_rows_come_from_the_top_and_every_pixel_is_drawn_once(device: Device) -> None:
    width, height = 70, 333  # several bands, the last one not whole
    with Frame(device, width, height) as frame:
        frame.draw(FragmentProgram(device, COORDINATES), {})
        drawn = frame.read()
    assert drawn.shape == (height, width, 4)
    assert drawn.dtype == np.float32
    x, y = np.meshgrid(np.arange(width) + 0.5, height - np.arange(height) - 0.5)
    np.testing.assert_array_equal(drawn[..., 0], x)
    np.testing.assert_array_equal(drawn[..., 1], y)
    np.testing.assert_array_equal(drawn[..., 3], 1.0)


def test_float_values_come_back_exactly_negative_infinite_and_tiny(device: Device) -> None:
    values = (-1.5e-30, 1234567.0, float("inf"), -3.0)
    text = HEAD + "uniform vec4 value;\nvoid main() { first = value; }\n"
    with Frame(device, 4, 4) as frame:
        frame.draw(FragmentProgram(device, text), {"value": values})
        np.testing.assert_array_equal(frame.read()[2, 3], np.array(values, np.float32))


def test_attachments_are_read_apart(device: Device) -> None:
    text = HEAD + "layout(location = 1) out vec4 second;\nvoid main() { first = vec4(1.0); second = vec4(2.0); }\n"
    with Frame(device, 8, 8, attachments=2) as frame:
        frame.draw(FragmentProgram(device, text), {})
        assert (frame.read(0) == 1.0).all()
        assert (frame.read(1) == 2.0).all()


def test_progress_grows_to_one_and_may_stop_the_drawing(device: Device) -> None:
    program = FragmentProgram(device, COORDINATES)
    shares: list[float] = []
    with Frame(device, 8, 1000) as frame:
        frame.draw(program, {}, shares.append)
        assert shares == sorted(set(shares))
        assert shares[-1] == 1.0
        assert len(shares) > 1

        def stop(share: float) -> None:
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            frame.draw(program, {}, stop)
        assert (frame.read()[-1, :, 3] == -1.0).all(), "rows after the stop are undrawn, and known as such"
        frame.draw(program, {})
        assert (frame.read()[..., 3] == 1.0).all(), "the frame is whole again afterwards"


def test_a_uniform_without_a_value_is_a_bug_and_an_unused_value_is_not(device: Device) -> None:
    program = FragmentProgram(device, HEAD + "uniform float radius;\nvoid main() { first = vec4(radius); }\n")
    assert program.uniform_names == {"radius"}
    program.set({"radius": 1.0, "optimised_away": (1.0, 2.0)})
    with pytest.raises(InternalError, match="no value for the uniforms radius"):
        program.set({})
    with pytest.raises(InternalError, match="uniform radius takes 1 numbers, got 2"):
        program.set({"radius": (1.0, 2.0)})


def test_whole_numbers_reach_integer_uniforms(device: Device) -> None:
    text = HEAD + "uniform int count;\nuniform ivec2 size;\nvoid main() { first = vec4(count, size, 1); }\n"
    with Frame(device, 2, 2) as frame:
        frame.draw(FragmentProgram(device, text), {"count": 7.0, "size": (640, 360)})
        assert frame.read()[0, 0].tolist() == [7.0, 640.0, 360.0, 1.0]


def test_a_refused_shader_shows_the_numbered_glsl_around_the_place(device: Device) -> None:
    text = HEAD + "void main() {\n    float a = 1.0;\n    first = vec4(missing);  // s.sdf:3:7\n}\n"
    with pytest.raises(ShaderRefusedError) as caught:
        FragmentProgram(device, text)
    assert caught.value.complaints[0].line == 5
    assert "missing" in caught.value.complaints[0].message
    assert "line 5 (made from s.sdf:3:7): error: " in str(caught.value)
    assert ">    5 |     first = vec4(missing);" in str(caught.value)
    assert "     4 |     float a = 1.0;" in str(caught.value)
    assert device.renderer in str(caught.value)


@pytest.mark.parametrize(
    ("log", "line", "message"),
    [
        (
            "GLSL Compiler failed\n\nfragment_shader\n====\n0:12(3): error: `y' undeclared\n",
            12,
            "error: `y' undeclared",
        ),
        ('0(7) : error C1503: undefined variable "y"\n', 7, 'error C1503: undefined variable "y"'),
        ("ERROR: 0:3: 'y' : undeclared identifier\n", 3, "'y' : undeclared identifier"),
        ("GLSL Linker failed\nerror: too many outputs\n", None, "GLSL Linker failed\nerror: too many outputs"),
    ],
)
def test_complaints_of_every_driver_are_read(log: str, line: int | None, message: str) -> None:
    (complaint,) = parse_complaints(log)
    assert (complaint.line, complaint.message) == (line, message)


def test_a_frame_too_large_for_the_device_is_the_devices_failure(device: Device) -> None:
    with pytest.raises(DeviceError, match="draws at most"):
        Frame(device, device.max_size + 1, 1)


def test_doctor_finds_that_what_is_needed_works(device: Device) -> None:
    findings = examine(device)
    assert [finding.name for finding in findings if not finding.works] == []
    assert len(findings) == 4
