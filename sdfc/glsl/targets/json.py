"""JSON: everything that a program needs to bind a scene, and the sources of all stages."""

from __future__ import annotations

from sdfc.glsl.targets.record import Target

_PAGE = "target/scene.json"

ENTRY = Target(
    name="json",
    doc="all that a program needs to bind the scene: uniforms, ranges, defaults, bounds, sources of all stages",
    use="read it",
    full={"fragment": "entry/picture.frag"},
    suffix={"fragment": ".json"},
    pixel={"fragment": "gl_FragCoord.xy"},
    version="450 core",
    is_description=True,
    page={"full": _PAGE, "field": _PAGE, "tracer": _PAGE},
)
