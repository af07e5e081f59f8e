"""Other people's shaders on our camera and rays, in the same context. docs/foreign.md says what they may rely on."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from sdfc.api.request import RequestError, View
from sdfc.glsl.assembly import VERSION
from sdfc.glsl.expression import literal
from sdfc.gpu.device import Device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram, ShaderRefusedError
from sdfc.measure.bench.answers import Size
from sdfc.measure.bench.entrants import Drawing, Drawn, Reply, coarser
from sdfc.pipeline import Compiled
from sdfc.plan.plan import FINE, HORIZON, SMALLEST_TOLERANCE
from sdfc.shape.lower import FAR

MOST_STEPS = 2048  # as many as our own tracers take where nothing forbids it

# Our names, in a shader that begins with somebody's text: renamed, so that both may use them.
TAKEN = (
    *("RADIUS", "CENTRE", "FAR", "MOST_STEPS", "steps", "evaluations", "unfinished", "travelled", "cone"),
    *("camera_ray", "rebase", "trace", "tolerance", "own_tolerance", "first_out"),
)

PRELUDE = f"""#version {VERSION}
uniform vec3 eye;
uniform vec3 axis_x;
uniform vec3 axis_y;
uniform vec3 axis_z;
uniform vec2 resolution;
uniform vec3 pixel;
uniform vec3 centre;
uniform float radius;
noperspective in vec3 ray_origin;
noperspective in vec3 ray_ahead;
#line 1
"""

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_VERSION = re.compile(r"^[ \t]*#version[^\n]*", re.MULTILINE)
_MAIN = re.compile(r"\bvoid\s+main\s*\(")
_MAP = re.compile(r"\bfloat\s+map\s*\(\s*(in\s+)?vec3\b")
_DEPTH = re.compile(r"\bout\s+vec4\s+depth_out\b")


@dataclass(slots=True, eq=False)
class Foreign:
    """A shader that is not ours, as an Entrant."""

    name: str
    path: Path
    text: str
    reply: Reply
    in_scene_units: bool
    compiled: Compiled
    device: Device
    note: str
    costs: Mapping[str, float] = field(default_factory=dict)
    _program: FragmentProgram | None = None

    @contextmanager
    def drawing(self, size: Size, tolerance: float) -> Iterator[Drawing]:
        """See Entrant."""
        uniforms: dict[str, Any] = dict(self.compiled.uniforms(View(), {}, size))
        if self.in_scene_units:
            uniforms = in_scene_units(uniforms, self.compiled, size)
        program = self._built(frozenset(uniforms))
        with Frame(self.device, *size, 1) as frame:
            yield Drawn(frame, program, coarser(uniforms, tolerance))

    def _built(self, known: frozenset[str]) -> FragmentProgram:
        if self._program is None:
            try:
                self._program = FragmentProgram(self.device, self.text, self.compiled.vertex())
            except ShaderRefusedError as error:
                raise RequestError(f"{self.device.renderer} refuses '{self.path}':\n{_said(error)}") from error
            unknown = sorted(self._program.uniform_names - known)
            if unknown:
                given = ", ".join(sorted(known))
                raise RequestError(f"'{self.path}' asks for {', '.join(unknown)}; the uniforms that are given: {given}")
        return self._program


def _said(error: ShaderRefusedError) -> str:
    """The driver's words, by the lines of the user's file."""
    return "\n".join(f"  line {c.line}: {c.message}" for c in error.complaints[:8])


def foreign(name: str, path: Path, compiled: Compiled, device: Device) -> Foreign:
    """Somebody's shader for this scene. Raises RequestError where the file is neither of the two kinds."""
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise RequestError(f"cannot read '{path}': {error}") from error
    code = _COMMENT.sub(" ", text)
    if _MAIN.search(code):
        whole = text if "#version" in code else PRELUDE + text
        reply = Reply.DEPTH if _DEPTH.search(code) else Reply.COVER
        return Foreign(name, path, whole, reply, True, compiled, device, f"a whole shader; it writes {reply.value}")
    if _MAP.search(code):
        marched = _marched(_VERSION.sub("", text), compiled)
        return Foreign(name, path, marched, Reply.DEPTH, False, compiled, device, "a distance, marched by `sphere`")
    raise RequestError(f"'{path}' has neither `void main()` nor `float map(vec3 p)`")


def _marched(text: str, compiled: Compiled) -> str:
    plan = compiled.plan
    return (
        _environment()
        .get_template("bench/map.frag")
        .render(
            version=VERSION,
            text=text,
            taken=TAKEN,
            most_steps=MOST_STEPS,
            radius=literal(plan.radius),
            centre=f"vec3({', '.join(literal(c) for c in plan.centre)})",
            far=literal(FAR),
            smallest=literal(SMALLEST_TOLERANCE),
            fine=literal(FINE),
            finite=plan.is_finite,
            horizon=literal(HORIZON),
        )
    )


@cache
def _environment() -> Environment:
    loader = PackageLoader("sdfc.templates", ".")
    return Environment(loader=loader, undefined=StrictUndefined, trim_blocks=True, autoescape=False)


def in_scene_units(uniforms: Mapping[str, Any], compiled: Compiled, size: Size) -> dict[str, Any]:
    """The camera's uniforms, made for the scene's own coordinates, in the units and the place of the scene's file."""
    radius, centre = compiled.plan.radius, compiled.plan.centre
    half, growth, perspective = uniforms["pixel"]
    across = 1.0 if perspective else radius  # the axes span the picture at distance 1, or where the camera stands
    return {
        **uniforms,
        "eye": tuple(radius * v + c for v, c in zip(uniforms["eye"], centre, strict=True)),
        "axis_x": tuple(across * v for v in uniforms["axis_x"]),
        "axis_y": tuple(across * v for v in uniforms["axis_y"]),
        "pixel": (half * radius, growth, perspective),
        "resolution": tuple(float(n) for n in size),
        "centre": centre,
        "radius": radius,
    }
