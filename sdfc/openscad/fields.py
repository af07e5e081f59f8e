"""Fields that only OpenSCAD's solids need, declared as in the standard library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from sdfc.diagnostics import Source, Span
from sdfc.field.graph import Expr, FieldGraph
from sdfc.scene.define import define
from sdfc.scene.formula import Helper
from sdfc.shape.definition import Definition
from sdfc.syntax import tree
from sdfc.syntax.parse import parse

TEXT = """
// How far out a corner's piece is: all pieces of a ring look alike, so that one of them is enough. The angle is folded.
def apothem(q, sides) = length(q) * cos(mod(atan(q.y, nonzero(q.x)), tau / sides) - pi / sides)

field faceted_ball(sides: count >= 3, normals: points2, offsets: numbers, radius: length > 0, height: length > 0)
    "OpenSCAD's ball of few pieces: rings of flat pieces between two caps at z = height and z = -height."
    = max(max(for i in 0..count(normals): dot(q, normals[i]) - offsets[i]),
          max(abs(p.z) - height, length(p.xy) - radius))
      where q = [apothem(p.xy, sides), abs(p.z)]
    exact inside
    convex
    bounds -[radius + level, radius + level, height + level] .. [radius + level, radius + level, height + level]

field faceted_cone(sides: count >= 3, bottom: length >= 0, top: length >= 0, height: length > 0)
    "OpenSCAD's cylinder of few pieces around z, centred; `bottom` and `top` are the radii of the corners."
    = max(max(abs(p.z) - height / 2, length(p.xy) - radius),
          (height * (apothem(p.xy, sides) - inner * (bottom + top) / 2) + inner * (bottom - top) * p.z) / slant)
      where inner = cos(pi / sides),
            radius = max(bottom, top),
            slant = length([height, inner * (bottom - top)])
    exact inside
    convex
    homogeneous
    bounds -[reach, reach, height / 2 + level] .. [reach, reach, height / 2 + level]
      where reach = max(bottom, top) + level

def lifted(across, along) = min(max(across, along), 0) + length(max([across, along], 0))

def unstretched(v, stretch, growth) = 2 * v / (stretch + sqrt(stretch * stretch + 2 * growth * abs(v)))

def sheared(c) = c / 2 + sqrt(1 + c * c / 4)

// k f(q / k), f a distance whose shape is within `reach`: along z it changes by k' (f - q . grad f), which is at most
// k' reach however small k becomes, since f(q) = grad f . (q - c) with the nearest point c
field tapered_extrusion(shape: profile, height: length > 0, top: number >= 0, rate: angle, reach: length > 0)
    "A profile drawn out along z, scaled on the way from 1 to `top` and turned by `rate` for each unit of length."
    = unstretched(lifted(k * shape([c * p.x - s * p.y, s * p.x + c * p.y] / k), abs(p.z) - height / 2),
                  sheared(abs(rate) * length(p.xy) + reach * abs(top - 1) / height), abs(rate))
      where k = max(mix(1, top, clamp(p.z / height + 0.5, 0, 1)), 0.000001),
            c = cos(rate * p.z),
            s = sin(rate * p.z)
    bound
    lipschitz max(shape.lipschitz, 1)
    bounds [-wide, -wide, -tall] .. [wide, wide, tall]
      where wide = if level > 0 then inf else reach * max(1, top),
            tall = if level > 0 then inf else height / 2
"""


@dataclass(frozen=True, slots=True)
class _Text:
    """What the formulas see: the functions of this text."""

    def value(self, name: str, span: Span) -> Expr | None:
        return None

    def function(self, name: str) -> Helper | None:
        declared = _declarations().get(name)
        return Helper(declared, self) if isinstance(declared, tree.FunctionDeclaration) else None

    def names(self) -> Sequence[str]:
        return list(_declarations())

    def literal(self, node: tree.Number, number: float) -> Expr | None:
        return None

    def step(self, span: Span) -> None:
        """Formulas of one's own are of a known size."""


@cache
def _declarations() -> MappingProxyType[str, tree.Statement]:
    statements = parse(Source("openscad/fields", TEXT)).statements
    kinds = (tree.FieldDeclaration, tree.FunctionDeclaration)
    return MappingProxyType({s.name.text: s for s in statements if isinstance(s, kinds)})


def field(name: str, values: FieldGraph) -> Definition | None:
    """The field of that name; a new object each time."""
    declared = _declarations().get(name)
    return define(declared, values, _Text()) if isinstance(declared, tree.FieldDeclaration) else None
