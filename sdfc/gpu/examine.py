"""What an OpenGL device can do of what sdfc asks, tried, not believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sdfc.diagnostics import DeviceError, InternalError
from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram

_HEAD = "#version 450 core\nlayout(location = 0) out vec4 result;\n"
_EXACT = 1234567.0  # needs all of a float32's mantissa but two bits
_ITERATIONS = 200000


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was tried on the device."""

    name: str
    works: bool
    remark: str = ""


def examine(device: Device) -> tuple[Finding, ...]:
    """Try on a device what rendering needs."""
    return tuple(_tried(name, trial, device) for name, trial in _TRIALS.items())


def _tried(name: str, trial: Callable[[Device], Finding], device: Device) -> Finding:
    try:
        return trial(device)
    except (DeviceError, InternalError) as error:
        return Finding(name, False, str(error).splitlines()[0])


def _drawn(device: Device, body: str, attachments: int = 1) -> float:
    program = FragmentProgram(device, _HEAD + body)
    try:
        with Frame(device, 8, 8, attachments) as frame:
            frame.draw(program, {"value": _EXACT})
            return float(frame.read(attachments - 1)[0, 0, 0])
    finally:
        program.release()


def _float_frames(device: Device) -> Finding:
    drawn = _drawn(device, "uniform float value;\nvoid main() { result = vec4(value); }\n")
    return Finding("float frames", drawn == _EXACT, "" if drawn == _EXACT else f"drew {drawn}, not {_EXACT}")


def _several_images(device: Device) -> Finding:
    outputs = "".join(f"layout(location = {index}) out vec4 result{index};\n" for index in range(1, 4))
    writes = "".join(f" result{index} = vec4({index}.0);" for index in range(1, 4))
    drawn = _drawn(device, f"{outputs}void main() {{ result = vec4(0.0);{writes} }}\n", attachments=4)
    return Finding("four images at once", drawn == 3.0)


def _compute_shaders(device: Device) -> Finding:
    import moderngl
    import numpy as np

    text = (
        "#version 450 core\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer Data { float data[]; };\n"
        "void main() { data[gl_GlobalInvocationID.x] = float(gl_GlobalInvocationID.x); }\n"
    )
    try:
        shader = device.context.compute_shader(text)
    except moderngl.Error as error:
        return Finding("compute shaders", False, str(error).strip().splitlines()[-1])
    buffer = device.context.buffer(reserve=32)
    buffer.bind_to_storage_buffer(0)
    shader.run(1)
    works = np.array_equal(np.frombuffer(buffer.read(), np.float32), np.arange(8))
    buffer.release()
    shader.release()
    return Finding("compute shaders", works)


def _long_loops(device: Device) -> Finding:
    """llvmpipe silently ends loops after 65 535 iterations (GL.md 0); sdfc proves that its own stay below."""
    body = (
        "uniform float value;\nvoid main() { float n = 0.0;"
        f" for (int i = 0; i < {_ITERATIONS}; i++) {{ n += 1.0; if (n > value) break; }} result = vec4(n); }}\n"
    )
    drawn = int(_drawn(device, body))
    remark = "" if drawn == _ITERATIONS else f"they end after {drawn} iterations; sdfc's own loops stay below"
    return Finding("long loops", drawn >= 65535, remark)


_TRIALS: dict[str, Callable[[Device], Finding]] = {
    "float frames": _float_frames,
    "four images at once": _several_images,
    "compute shaders": _compute_shaders,
    "long loops": _long_loops,
}
