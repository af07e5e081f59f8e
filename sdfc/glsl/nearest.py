"""What is nearest to any point: gradient and material of the part whose distance the field's is.

The surface function of a shader (sdfc/glsl/surface) is for hits alone: it asks sharp functions, and looks back along
the ray. This one asks the distances themselves, at any point.
"""

from __future__ import annotations

from collections.abc import Sequence

from sdfc.field.graph import FieldGraph
from sdfc.glsl.body import Body
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.source import joined, parse, renamed
from sdfc.glsl.surface import SurfaceText, SurfaceWriter
from sdfc.plan.steps import Part, Step
from sdfc.shape.material import Material

_NAMES = {
    "Surface": "Nearest",
    "surface": "nearest",
    "nearer": "nearer_of",
    "farther": "farther_of",
    "painted": "painted_as",
    "blended": "blended_of",
}
_NO_SINKING = "0.0"


class NearestWriter(SurfaceWriter):
    """Writes `Nearest nearest(vec3 p)`."""

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        materials: Sequence[Material],
        slopes: dict[int, float],
    ) -> None:
        super().__init__(graph, functions, live, materials, None)
        self._names = {id(m): functions.names.fresh(f"{m.name}_nearest") for m in materials}
        self._slopes = slopes  # the Lipschitz constant of each part's formula, by id

    def write(self, root: Step) -> SurfaceText:
        body = Body(self._live)
        result = self._fold(root, body)
        body.add(f"return {result};")
        function = "\n".join(["Surface surface(vec3 p) {", *body.lines, "}", ""])
        return SurfaceText(_other_names(self._structure()), _other_names(function), self._properties())

    def _leaf(self, part: Part, body: Body, inside: bool, role: Role, sunk: str, scale: float = 1.0) -> str:
        # the operands of a blend are asked for their distances already: those, its weights need as they are
        own = 1.0 if role is Role.DISTANCE_SURFACE else 1.0 / max(self._slopes[id(part)], 1e-9)
        return super()._leaf(part, body, inside, Role.DISTANCE_SURFACE, _NO_SINKING, own)


def _other_names(text: str) -> str:
    return joined(renamed(parse(text), _NAMES))
