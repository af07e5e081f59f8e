"""What the desktop and ES targets share."""

from __future__ import annotations

FRAGMENT = {"fragment": "entry/picture.frag"}
BOTH = FRAGMENT | {"compute": "entry/picture.comp"}
SUFFIXES = {"fragment": ".frag", "compute": ".comp", "vertex": ".vert"}
PIXEL = {"fragment": "gl_FragCoord.xy", "compute": "vec2(gl_GlobalInvocationID.xy) + 0.5"}
COVER = "draw one triangle that covers the picture, and write the camera's uniforms (docs/emit-glsl.md says how)"
