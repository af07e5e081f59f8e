"""three.js: an ES module."""

from __future__ import annotations

from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="three",
    doc="an ES module for three.js: a ShaderMaterial on a box that writes depth, or GLSL to include (field, tracer)",
    use="scene.add(createMesh()); a param is set by uniforms[params.NAME.uniform].value",
    full={"fragment": "target/box.frag"},
    suffix={"fragment": ".js"},
    camera="target/box_camera.glsl",
    start="entry - travelled",
    is_prefixed=True,
    page={"full": "target/three.js", "field": "target/three_part.js", "tracer": "target/three_part.js"},
)
