"""Fragment programs: GLSL text to something that draws, and refusals that show the place."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from sdfc.diagnostics import InternalError
from sdfc.gpu.device import Device

if TYPE_CHECKING:
    import moderngl

Value: TypeAlias = "float | tuple[float, ...]"

# One triangle that covers the frame, from the vertex's number alone: no buffers, no attributes, no diagonal seam.
COVERING = """#version 450 core
void main() {
    gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0);
}
"""

_COMPLAINT_PATTERNS = (
    re.compile(r"^\d+:(?P<line>\d+)\(\d+\): (?P<message>error.*)$", re.MULTILINE),  # Mesa
    re.compile(r"^\d+\((?P<line>\d+)\) : (?P<message>error.*)$", re.MULTILINE),  # NVIDIA
    re.compile(r"^ERROR: \d+:(?P<line>\d+): (?P<message>.*)$", re.MULTILINE),  # ANGLE, AMD, glslang
)
_CONTEXT_LINES = 3
_MOST_SHOWN = 4  # one mistake in a template often raises a hundred complaints

_PLACE = re.compile(r"// (\S+:\d+:\d+)\s*$")  # how the emitter says what a line was made from

_INTEGER_FORMATS = frozenset("iu")


@dataclass(frozen=True, slots=True)
class Complaint:
    """One error of the driver's compiler: the line of the GLSL (from 1; None for the linker's) and its words."""

    line: int | None
    message: str


class ShaderRefusedError(InternalError):
    """A driver refused our GLSL, which is always our bug."""

    def __init__(self, renderer: str, complaints: tuple[Complaint, ...], text: str) -> None:
        excerpts = "\n".join(_excerpt(complaint, text) for complaint in complaints[:_MOST_SHOWN])
        more = f"\n... and {len(complaints) - _MOST_SHOWN} more" if len(complaints) > _MOST_SHOWN else ""
        super().__init__(f"{renderer} refused the generated GLSL\n{excerpts}{more}")
        self.complaints = complaints
        self.text = text


def parse_complaints(log: str) -> tuple[Complaint, ...]:
    """The errors in a driver's log; the whole log as one where its form is unknown."""
    for pattern in _COMPLAINT_PATTERNS:
        found = tuple(Complaint(int(match["line"]), match["message"].strip()) for match in pattern.finditer(log))
        if found:
            return found
    return (Complaint(None, log.strip()),)


def _excerpt(complaint: Complaint, text: str) -> str:
    lines = text.split("\n")
    if complaint.line is None or not 1 <= complaint.line <= len(lines):
        return complaint.message
    first = max(1, complaint.line - _CONTEXT_LINES)
    last = min(len(lines), complaint.line + _CONTEXT_LINES)
    numbered = [
        f"{'>' if number == complaint.line else ' '}{number:5d} | {lines[number - 1][:160]}"
        for number in range(first, last + 1)
    ]
    place = _PLACE.search(lines[complaint.line - 1])
    made_from = f" (made from {place[1]})" if place else ""
    return "\n".join([f"line {complaint.line}{made_from}: {complaint.message}", *numbered])


class FragmentProgram:
    """A compiled fragment shader, drawn as one triangle that covers the frame."""

    def __init__(self, device: Device, fragment: str, vertex: str = COVERING) -> None:
        import moderngl

        self.device = device
        device.make_current()
        try:
            self._program = device.context.program(vertex_shader=vertex, fragment_shader=fragment)
        except moderngl.Error as error:
            raise ShaderRefusedError(device.renderer, parse_complaints(str(error)), fragment) from error
        self._uniforms: dict[str, Any] = {
            name: self._program[name] for name in self._program if isinstance(self._program[name], moderngl.Uniform)
        }
        self._array: moderngl.VertexArray = device.context.vertex_array(self._program, [])

    @property
    def uniform_names(self) -> frozenset[str]:
        """The uniforms that the driver kept."""
        return frozenset(self._uniforms)

    def set(self, values: Mapping[str, Value]) -> None:
        """Write every uniform. One without a value is a bug; a value that the driver optimised away is not."""
        self.device.make_current()
        missing = sorted(self._uniforms.keys() - values.keys())
        if missing:
            raise InternalError(f"no value for the uniforms {', '.join(missing)}")
        for name, uniform in self._uniforms.items():
            uniform.value = _converted(name, uniform, values[name])

    def draw(self) -> None:
        """Draw into the frame in use."""
        import moderngl

        self._array.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Free the program on the device."""
        self.device.make_current()
        self._array.release()
        self._program.release()


def _converted(name: str, uniform: Any, value: Value) -> Any:
    """The value as moderngl wants it for this uniform: one number or a tuple of the right length and kind."""
    numbers = value if isinstance(value, tuple) else (value,)
    if len(numbers) != uniform.dimension * uniform.array_length:
        raise InternalError(f"uniform {name} takes {uniform.dimension} numbers, got {len(numbers)}")
    cast = int if uniform.fmt[-1] in _INTEGER_FORMATS else float
    converted = tuple(cast(number) for number in numbers)
    return converted if len(converted) > 1 else converted[0]
