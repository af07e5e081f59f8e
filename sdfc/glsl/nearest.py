"""What is nearest to any point: gradient and material of the part whose distance the field's is.

Where nothing blends, looks belong to materials alone: a point has the number of one, and they are listed once.

The surface function of a shader (sdfc/glsl/surface) is for hits alone: it asks sharp functions, and looks back along
the ray. This one asks the distances themselves, at any point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.field.graph import FieldGraph
from sdfc.glsl.body import Body
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.source import joined, parse, renamed
from sdfc.glsl.surface import PROPERTIES, SurfaceWriter, property_of
from sdfc.plan.steps import Ball, Blend, Part, Step, leaves_of
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


@dataclass(frozen=True, slots=True)
class NearestText:
    """`structure` declares Nearest and what makes and joins one, `function` is `nearest(p)`, `properties` the body of a
    function of `p` that gives the Properties there."""

    structure: str
    function: str
    properties: str


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
        self._is_listed = False

    def written(self, root: Step) -> NearestText:
        self._is_listed = not any(_is_blend(leaf) for leaf in leaves_of(root))
        if self._is_listed:
            self._varying = []
        body = Body(self._live)
        result = self._fold(root, body)
        body.give(result)
        function = "\n".join(["Surface surface(vec3 p) {", *body.written(), "}", ""])
        properties = self._listed() if self._is_listed else self._mixed()
        return NearestText(_other_names(self._structure()), _other_names(function), "\n".join(properties))

    def _constructor(self, index: int, material: Material) -> list[str]:
        return [] if self._is_listed else super()._constructor(index, material)

    def _choice(self) -> list[str]:
        return [] if self._is_listed else super()._choice()

    def _made(self, constructor: str, field: str, rank: str, *more: str) -> str:
        if not self._is_listed:
            return super()._made(constructor, field, rank, *more)
        numbers = {self._names[id(m)]: f"{i}.0" for i, m in enumerate(self._materials)}
        return f"Surface({field}, {more[0] if more else numbers[constructor]})"

    def _mixed(self) -> list[str]:
        values = self._properties()
        return ["    Nearest s = nearest(p);", f"    return Properties({', '.join(values[n] for n in PROPERTIES)});"]

    def _listed(self) -> list[str]:
        lines = []
        for index, material in enumerate(self._materials[1:], 1):
            look = self._look(material, 2)
            choice = f"    if (s.material == {index}.0)"
            lines += [f"{choice} {look[0].lstrip()}"] if len(look) == 1 else [f"{choice} {{", *look, "    }"]
        head = ["    Nearest s = nearest(p);"] if lines else []
        return [*head, *lines, *self._look(self._materials[0], 1)]

    def _look(self, material: Material, indent: int) -> list[str]:
        body = Body(self._live, indent)
        texts = body.texts([property_of(material, name) for name in PROPERTIES])
        body.add(f"return Properties({', '.join(texts)});")
        return body.lines

    def _gradient_name(self, part: Part, role: Role) -> str:
        return f"g_{part.name}"

    def _leaf(
        self,
        part: Part,
        body: Body,
        inside: bool,
        role: Role,
        sunk: str,
        scale: float = 1.0,
        flat: Ball | None = None,
    ) -> str:
        # the operands of a blend are asked for their distances already: those, its weights need as they are
        own = 1.0 if role is Role.DISTANCE_SURFACE else 1.0 / max(self._slopes[id(part)], 1e-9)
        return super()._leaf(part, body, inside, Role.DISTANCE_SURFACE, _NO_SINKING, own)


def _is_blend(step: Step) -> bool:
    match step:
        case Blend():
            return True
        case _:
            return False


def _other_names(text: str) -> str:
    return joined(renamed(parse(text), _NAMES))
