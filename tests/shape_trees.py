"""Random shape trees for property tests: standard and users' fields, moved, combined and painted, with live params."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sdfc.diagnostics import Source, Span
from sdfc.facts.bounds import Bounds
from sdfc.facts.ranges import Range, Ranges
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.field.numeric import Evaluator
from sdfc.scene.define import IN_PLANE, define
from sdfc.scene.library import Library
from sdfc.shape.definition import Argument, Definition, Kind
from sdfc.shape.graph import Shape, ShapeGraph
from sdfc.shape.lower import lower
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix, inverse, matrix, rotation, scaling, translation
from sdfc.syntax.parse import parse

Array = NDArray[np.float64]
SPAN = Span(Source("tree.sdf", "tree"), 0, 4)
RANGES: dict[str, Range] = {
    "size": ((0.3,), (1.4,)),
    "turn": ((-3.0,), (2.0,)),
    "shift": ((-0.8, -0.2, 0.0), (0.5, 0.7, 0.4)),
}
# SDFC_TREE_EXAMPLES=300 looks harder
settings.register_profile(
    "trees",
    max_examples=int(os.environ.get("SDFC_TREE_EXAMPLES", "20")),
    deadline=None,
    suppress_health_check=list(HealthCheck),
    derandomize="SDFC_TREE_EXAMPLES" not in os.environ,
    database=None,
)
checked = settings.get_profile("trees")
seeds = st.integers(0, 2**32 - 1)

# what of each field is drawn; the rest has its default
SOLIDS = {
    "sphere": ("radius",),
    "box": ("size",),
    "torus": (),
    "cylinder": ("radius", "height"),
    "ellipsoid": ("radii",),
    "capsule": ("radius",),
    "rounded_box": (),
    "box_frame": (),
    "cone": ("radius", "height"),
    "link": (),
    "plane": ("offset",),
    "slab": ("thickness",),
    "wedge": ("size",),
    "gyroid": (),
}
PROFILES: dict[str, tuple[str, ...]] = {
    "circle": ("radius",),
    "rectangle": ("size",),
    "ellipse": ("radii",),
    "polygon": (),
    "star": (),
    "half_plane": ("offset",),
    "ring": ("radius",),
}
ONE_CHILD = {
    "round": ("radius",),
    "offset": ("distance",),
    "shell": ("thickness",),
    "hollow": (),
    "onion": (),
    "elongate": ("amount",),
    "twist": ("rate",),
    "bend": ("rate",),
    "taper": (),
    "displace": ("amplitude", "wavelength"),
    "shear_wave": (),
    "mirror_x": (),
    "symmetric": (),
    "bounded": (),
}
TWO_CHILDREN = {
    "smooth_union": ("blend",),
    "smooth_union_circular": ("blend",),
    "smooth_union_exponential": ("blend",),
    "smooth_union_round": ("blend",),
    "smooth_intersection": ("blend",),
    "smooth_intersection_cubic": ("blend",),
    "chamfer_union": ("chamfer",),
    "morph": ("amount",),
    "seam": (),
    "engrave": (),
}
IN_THE_PLANE = ("round", "shell", "offset", "smooth_union", "smooth_intersection")
LIFTS = {"extrude": ("height",), "revolve": ("offset",), "extrude_twisted": ("rate",), "extrude_rounded": ()}
USERS = """
field bumpy(size: length > 0 = 0.7)
    = length(p) - size + 0.1 * sin(5 * p.x) * cos(4 * p.y)
    bounds -[1, 1, 1] * (size + 0.1) .. [1, 1, 1] * (size + 0.1)

field quadric(radius: length > 0 = 0.6)
    = dot(p, p) - radius * radius
    bounds -[radius, radius, radius] .. [radius, radius, radius]

field swell(shape: solid, by: number > 0 = 2)
    = by * shape(p) * (1.5 + 0.5 * sin(p.x))
    bounds shape.lo .. shape.hi
"""
USER_SOLIDS = {"bumpy": ("size",), "quadric": ("radius",)}


@dataclass(slots=True)
class World:
    """One compilation's graphs and facts."""

    values: FieldGraph = field(default_factory=FieldGraph)
    shapes: ShapeGraph = field(default_factory=ShapeGraph)
    ranges: Ranges = field(default_factory=lambda: Ranges(RANGES))
    library: Library = field(init=False)
    bounds: Bounds = field(init=False)
    _users: dict[str, Definition] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.library = Library(self.values)
        self.bounds = Bounds(self.values, self.ranges)

    def definition(self, name: str) -> Definition:
        if name in self._users:
            return self._users[name]
        if name in ("bumpy", "quadric", "swell"):
            self.declare(USERS)
            return self._users[name]
        found = self.library.definition(name)
        assert found is not None, name
        return found

    def declare(self, text: str) -> None:
        """The fields of a text."""
        for statement in parse(Source("fields.sdf", text)).statements:
            made = define(statement, self.values)  # type: ignore[arg-type]
            self._users[made.name] = made

    def apply(self, name: str, *children: Shape, **arguments: Argument | float) -> Shape:
        """A field by name, with some arguments and else its defaults."""
        definition = self.definition(name)
        environment: dict[str, Argument] = {}
        for parameter in definition.values:
            if parameter.name in arguments:
                given = arguments[parameter.name]
                environment[parameter.name] = self.values.constant(given) if isinstance(given, float | int) else given
            else:
                assert parameter.default is not None
                environment[parameter.name] = parameter.default(environment)
        return self.shapes.apply(definition, environment.values(), children, SPAN)

    def moved(self, by: Matrix, child: Shape) -> Shape:
        return self.shapes.affine(by, inverse(by), child, SPAN)

    def at(self, x: float, y: float, z: float, child: Shape) -> Shape:
        return self.moved(translation(self.values, x, y, z), child)

    def material(self, name: str) -> Material:
        one, zero, rgb = self.values.constant(1.0), self.values.constant(0.0), self.values.constant(1.0, 0.5, 0.2)
        return Material(name, rgb, zero, one, rgb, zero, one * 1.5, rgb)

    def value(self, shape: Shape, points: Array, params: dict[str, Any]) -> Array:
        """The shape's field at points (k, n)."""
        p = self.values.input("p", Type(shape.dimension))
        (made,) = Evaluator([lower(shape, p)])({"p": points}, params)
        return np.broadcast_to(made, points.shape[-1:])


def some_params(generator: np.random.Generator) -> dict[str, Any]:
    """Values within the ranges; ends among them."""
    made: dict[str, Any] = {}
    for name, (lo, hi) in RANGES.items():
        share = np.clip(generator.uniform(-0.2, 1.2, len(lo)), 0, 1)
        values = np.array(lo) + share * (np.array(hi) - np.array(lo))
        made[name] = values if len(lo) > 1 else float(values[0])
    return made


def points_around(generator: np.random.Generator, count: int, dimension: int = 3, spread: float = 2.0) -> Array:
    """Random points, most of them where the trees are."""
    wide = generator.uniform(-spread, spread, (dimension, count))
    return np.concatenate([wide, 0.4 * spread * generator.normal(size=(dimension, count))], axis=1)


# --- strategies


def _number(draw: st.DrawFn, world: World, low: float, high: float, live: bool) -> Expr:
    """Between the limits; sometimes live."""
    if live and draw(st.integers(0, 4)) == 0:
        lo, hi = RANGES["size"][0][0], RANGES["size"][1][0]
        share = (world.values.param("size") - lo) / (hi - lo)
        return low + share * (high - low)
    return world.values.constant(draw(st.floats(low, high)))


def _argument(draw: st.DrawFn, world: World, kind: Kind, name: str, live: bool) -> Argument:
    low, high = {"offset": (-0.3, 0.3), "distance": (-0.1, 0.2), "rate": (-1.5, 1.5), "amount": (0.0, 1.0)}.get(
        name, (0.15, 0.9)
    )
    if name in ("blend", "chamfer", "thickness", "amplitude"):
        low, high = 0.02, 0.4
    size = {Kind.POINT3: 3, Kind.VECTOR3: 3, Kind.POINT2: 2, Kind.VECTOR2: 2}.get(kind, 1)
    parts = [_number(draw, world, low, high, live) for _ in range(size)]
    return parts[0] if size == 1 else world.values.vector(*parts)


def _applied(
    draw: st.DrawFn, world: World, name: str, drawn: Sequence[str], children: Sequence[Shape], live: bool
) -> Shape:
    kinds = {p.name: p.kind for p in world.definition(name).values}
    return world.apply(name, *children, **{n: _argument(draw, world, kinds[n], n, live) for n in drawn})


def _one_map(draw: st.DrawFn, world: World, kinds: Sequence[str], live: bool) -> Matrix:
    values = world.values
    kind = draw(st.sampled_from(kinds))
    is_live = live and draw(st.integers(0, 3)) == 0
    size = values.param("size") if is_live else values.constant(draw(st.floats(0.3, 2.0)))
    match kind:
        case "translate":
            shift = values.param("shift", Type.VEC3)
            steps: list[Expr] = [values.constant(draw(st.floats(-0.8, 0.8))) for _ in range(3)]
            if is_live:
                steps = [shift[0], shift[1], shift[2]]
            return translation(values, *steps)
        case "rotate":
            angle = values.param("turn") if is_live else values.constant(draw(st.floats(-3.0, 3.0)))
            return rotation(values, draw(st.integers(0, 2)), angle)
        case "scale":
            return scaling(values, size, size, size)
        case "stretch":
            return scaling(values, size, draw(st.floats(0.4, 1.5)), 1.0)
        case "mirror":
            return scaling(values, *draw(st.permutations([-1.0, 1.0, 1.0])))
        case _:
            return matrix(values, [[1, size * 0.5, 0], [0, 1, 0], [0.2, 0, 1]], [0, 0, 0.1])


RIGID = ("translate", "rotate", "mirror")
SIMILAR = (*RIGID, "scale")
ALL_MAPS = (*SIMILAR, "stretch", "shear")


@st.composite
def maps(draw: st.DrawFn, world: World, kinds: Sequence[str] = ALL_MAPS, live: bool = True) -> Matrix:
    """One to three maps after each other."""
    result = _one_map(draw, world, kinds, live)
    for _ in range(draw(st.integers(0, 2))):
        result = _one_map(draw, world, kinds, live).after(result)
    return result


def plane_map(draw: st.DrawFn, world: World, live: bool) -> Matrix:
    """A map of the plane: the third axis stays."""
    values = world.values
    size = values.param("size") if live and draw(st.booleans()) else values.constant(draw(st.floats(0.4, 1.5)))
    match draw(st.sampled_from(["translate", "rotate", "scale", "stretch"])):
        case "translate":
            return translation(values, draw(st.floats(-0.5, 0.5)), size * 0.3, 0.0)
        case "rotate":
            return rotation(values, 2, size * 2)
        case "scale":
            return scaling(values, size, size, 1.0)
        case _:
            return matrix(values, [[size, 0.3, 0], [0, 1, 0], [0, 0, 1]], [0.1, 0, 0])


@dataclass(frozen=True, slots=True)
class Menu:
    """What trees may be made of."""

    solids: dict[str, tuple[str, ...]] = field(default_factory=lambda: SOLIDS)
    one_child: dict[str, tuple[str, ...]] = field(default_factory=lambda: ONE_CHILD)
    two_children: dict[str, tuple[str, ...]] = field(default_factory=lambda: TWO_CHILDREN)
    lifts: dict[str, tuple[str, ...]] = field(default_factory=lambda: LIFTS)
    maps: Sequence[str] = ALL_MAPS
    materials: bool = False
    nothing: bool = True
    live: bool = True
    sets: Sequence[str] = ("union", "intersection", "difference", "complement")


@st.composite
def solids(draw: st.DrawFn, world: World, menu: Menu = Menu(), depth: int = 3) -> Shape:
    """A random solid."""
    again: Callable[[], Shape] = lambda: draw(solids(world, menu, depth - 1))  # noqa: E731
    words = ["primitive"]
    if depth > 0:
        words += ["affine", "affine", *menu.sets]
        words += ["one"] * bool(menu.one_child) + ["two"] * bool(menu.two_children) + ["lift"] * bool(menu.lifts)
        words += ["paint"] * menu.materials
    word = draw(st.sampled_from(words))
    match word:
        case "affine":
            by = draw(maps(world, menu.maps, menu.live))
            return world.moved(by, again())
        case "union" | "intersection":
            parts = [again() for _ in range(draw(st.integers(1, 3)))]
            return getattr(world.shapes, word)(parts, SPAN)  # type: ignore[no-any-return]
        case "difference":
            return world.shapes.difference(again(), [again()], SPAN)
        case "complement":
            return world.shapes.complement(again(), SPAN)
        case "one":
            name = draw(st.sampled_from(sorted(menu.one_child)))
            return _applied(draw, world, name, menu.one_child[name], [again()], menu.live)
        case "two":
            name = draw(st.sampled_from(sorted(menu.two_children)))
            return _applied(draw, world, name, menu.two_children[name], [again(), again()], menu.live)
        case "lift":
            name = draw(st.sampled_from(sorted(menu.lifts)))
            return _applied(draw, world, name, menu.lifts[name], [draw(profiles(world, menu.live))], menu.live)
        case "paint":
            return world.shapes.paint(world.material(draw(st.sampled_from("rgb"))), again(), SPAN)
        case _:
            if menu.nothing and draw(st.integers(0, 20)) == 0:
                return world.shapes.nothing(SPAN)
            name = draw(st.sampled_from(sorted(menu.solids)))
            return _applied(draw, world, name, menu.solids[name], [], menu.live)


@st.composite
def profiles(draw: st.DrawFn, world: World, live: bool = True, depth: int = 2) -> Shape:
    """A random profile."""
    again: Callable[[], Shape] = lambda: draw(profiles(world, live, depth - 1))  # noqa: E731
    words = ["primitive"] + (["affine", "union", "difference", "one"] if depth > 0 else [])
    match draw(st.sampled_from(words)):
        case "affine":
            return world.moved(plane_map(draw, world, live), again())
        case "union":
            return world.shapes.union([again(), again()], SPAN)
        case "difference":
            return world.shapes.difference(again(), [again()], SPAN)
        case "one":
            name = draw(st.sampled_from(IN_THE_PLANE)) + IN_PLANE
            children = [again() for _ in world.definition(name).children]
            return _applied(draw, world, name, (), children, live)
        case _:
            name = draw(st.sampled_from(sorted(PROFILES)))
            return _applied(draw, world, name, PROFILES[name], [], live)
