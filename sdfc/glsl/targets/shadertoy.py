"""Shadertoy: paste and run."""

from __future__ import annotations

from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="shadertoy",
    doc="Shadertoy's Image tab (full) or Common tab (field, tracer): params are constants at the top, the mouse orbits",
    use="paste all of it; drag the mouse to move around the scene",
    full={"fragment": "target/shadertoy.glsl"},
    suffix={"fragment": ".glsl"},
    camera="target/shadertoy_camera.glsl",
    pixel={"fragment": "pixel_centre"},
    is_baked=True,
)
