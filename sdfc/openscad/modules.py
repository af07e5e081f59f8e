"""What each of OpenSCAD's modules makes. One row for each name that a flattened file may have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sdfc.diagnostics import scene_error
from sdfc.openscad import booleans, flats, hulls, solids, sweeps
from sdfc.openscad.invocation import Invocation
from sdfc.openscad.part import Part


@dataclass(frozen=True, slots=True)
class Module:
    """`build` makes the part; `positional` names the arguments that may come without a name."""

    build: Callable[[Invocation], Part | None]
    positional: tuple[str, ...] = ()


def _no_form(reason: str, hint: str) -> Module:
    def build(m: Invocation) -> Part | None:
        raise scene_error(f"`{m.call.name}` {reason}", m.span, hint)

    return Module(build)


_FROM_FILE = "has no distance form: it reads another file"
_UNION = Module(booleans.union)

MODULES: dict[str, Module] = {
    # booleans, and what passes its children on
    "group": _UNION,
    "union": _UNION,
    "render": _UNION,
    "intersection": Module(booleans.intersection),
    "difference": Module(booleans.difference),
    # look and place
    "color": Module(booleans.color, ("c", "alpha")),
    "multmatrix": Module(booleans.multmatrix, ("m",)),
    "resize": Module(booleans.resize, ("newsize", "auto")),
    # solids
    "cube": Module(solids.cube, ("size", "center")),
    "sphere": Module(solids.sphere, ("r",)),
    "cylinder": Module(solids.cylinder, ("h", "r1", "r2", "center")),
    "polyhedron": Module(solids.polyhedron, ("points", "faces", "convexity")),
    # in the plane
    "circle": Module(flats.circle, ("r",)),
    "square": Module(flats.square, ("size", "center")),
    "polygon": Module(flats.polygon, ("points", "paths", "convexity")),
    "offset": Module(flats.offset, ("r",)),
    # from the plane to space
    "linear_extrude": Module(sweeps.linear_extrude, ("height",)),
    "rotate_extrude": Module(sweeps.rotate_extrude, ("angle",)),
    # sums
    "hull": Module(hulls.hull),
    "minkowski": Module(hulls.minkowski),
    # what no distance form is known for
    "text": _no_form("has no distance form here", "draw the letters with `polygon`"),
    "projection": _no_form("has no distance form", "draw the outline with `polygon`"),
    "surface": _no_form(_FROM_FILE, "build it from solids"),
    "import": _no_form(_FROM_FILE, "build it from solids"),
    "fill": _no_form("has no distance form here", "leave out the holes"),
    "roof": _no_form("has no distance form here", "`linear_extrude` with a scale has one"),
}
