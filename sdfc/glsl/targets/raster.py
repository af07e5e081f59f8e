"""A box drawn by an engine's rasteriser, whose pixels find the solid inside it and write its depth (Liktor 2008, 5)."""

from __future__ import annotations

from sdfc.glsl.targets.desktop import SUFFIXES
from sdfc.glsl.targets.record import Target

_WHY = "it is a pair of stages that draw a box; glsl330 has the part on its own"

ENTRY = Target(
    name="raster",
    doc="OpenGL 3.3 vertex and fragment stage of a box that writes gl_FragDepth: the solid sorts with polygons",
    use="draw 14 vertices as a triangle strip, no attributes, front faces culled, depth test on; "
    "clip_from_scene is projection * view * model, scene_from_clip its inverse",
    full={"fragment": "target/box.frag", "vertex": "target/raster.vert"},
    suffix=SUFFIXES,
    version="330 core",
    refused={"field": _WHY, "tracer": _WHY},
    camera="target/box_camera.glsl",
    start="entry - travelled",
    is_prefixed=True,
    is_pair=True,
)
