"""Small scenes, one for each way that text is made; and what stands in the templates."""

from __future__ import annotations

import re
from pathlib import Path

from sdfc import pipeline
from sdfc.diagnostics import Source
from sdfc.pipeline import Compiled

ROOT = Path(__file__).parent.parent.parent
TEMPLATES = ROOT / "templates"

SMALL = {
    "events": "scene { (box(size: [1, 1, 1]) & sphere(radius: 0.6)) - cylinder(radius: 0.3, height: 2) }",
    "tangent": "param edge = 0.1 in 0.0..0.2\nscene { rounded_box(size: [1, 0.6, 1], radius: edge).rotate(y: 30deg) }",
    "balls": "scene { torus(major: 0.6, minor: 0.2) - box(size: [1, 1, 1]).twist(20deg) }",
    "blend": "material red { color: #ff3020 }\nmaterial blue { color: #2030ff, roughness: 0.2 }\n"
    "scene { union(blend: 0.2) { sphere(radius: 0.4).material(red) box(size: [1, 0.3, 0.3]).material(blue) } }",
    "many": "scene { union(for i in 0..50: sphere(radius: 0.1 + 0.001 * i).translate([i, mod(i, 7), mod(i, 3)])) }",
    "setting": "param high = 2 in 1..3\nmaterial glass { transmission: 1, ior: 1.5, tint: #e0ffe8 }\n"
    "camera { eye: [2, high, 3], target: [0, 0, 0], fov: 40deg }\n"
    "light sun { direction: [-1, -2, -1], color: #fff0d0, intensity: 3 }\n"
    "light point { position: [1, 2, 1], color: #ffffff, intensity: 4 }\n"
    "sky { zenith: #6080c0, horizon: #ffffff }\n"
    "scene { plane(normal: [0, 1, 0], offset: -0.5) sphere(radius: 0.5).material(glass) }",
}

ENTRIES = (("picture", "fragment"), ("picture", "compute"), ("radiance", "fragment"), ("probe", "fragment"))


def compiled_text(text: str, tracer: str = "proven") -> Compiled:
    """A scene's text, compiled."""
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text), None), pipeline.Options(tracer))


def compiled_file(path: Path) -> Compiled:
    """A scene's file, compiled."""
    kind: pipeline.Kind = "csg" if path.suffix == ".csg" else "sdf"
    return pipeline.compile_scene(pipeline.load(Source(path.name, path.read_text()), path.parent, kind))


def template_words() -> set[str]:
    """Every function, global, constant, uniform and struct that the templates themselves define."""
    words: set[str] = set()
    for path in sorted(TEMPLATES.rglob("*")):
        if path.suffix not in (".glsl", ".frag", ".comp", ".vert") or path.name == "polish.glsl":  # a piece of a body
            continue
        if path.parent.name == "calibrate":  # no scene is in those
            continue
        text = re.sub(r"//.*", "", path.read_text())
        text = re.sub(r"\{%.*?%\}|\{\{.*?\}\}", "0", text)
        depth = 0
        for line in text.split("\n"):
            if depth == 0:
                words |= _defined(line)
            depth += line.count("{") - line.count("}")
    return words - {"main"}


_QUALIFIERS = r"(?:[a-z]+\([^)]*\)\s*)?(?:(?:const|uniform|noperspective|flat|in|out|writeonly)\s+)*"
_TYPE = r"(?:void|float|int|bool|vec[234]|ivec[234]|mat[234]|image2D|Surface)"


def _defined(line: str) -> set[str]:
    found = re.match(rf"\s*{_QUALIFIERS}{_TYPE}\s+(\w+)\s*[(;=\[]", line)
    struct = re.match(r"\s*struct\s+(\w+)", line)
    return {match.group(1) for match in (found, struct) if match}
