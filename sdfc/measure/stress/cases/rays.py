"""Rays that nobody meets by chance: tangents, through corners, along faces and axes, from within."""

from __future__ import annotations

from sdfc.measure.stress.record import ORIGIN, Case, Family, Point, look, needle, parallel, scene

_ROUND = {  # solids whose silhouette, seen along -z, has its top at height 0.5
    "sphere": "sphere(radius: 0.5)",
    "cylinder": "cylinder(radius: 0.5, height: 1.2).rotate(z: 90deg)",
    "cone": "cone(radius: 0.5, height: 1).rotate(z: 90deg)",
    "ellipsoid": "ellipsoid(radii: [0.8, 0.5, 0.3])",
    "torus": "torus(major: 0.38, minor: 0.12).rotate(x: 90deg)",
    "capsule": "capsule(from: [-0.4, 0.3, 0], to: [0.4, 0.3, 0], radius: 0.2)",
    "rounded box": "rounded_box(size: [1, 1, 1], radius: 0.2)",
    "blend": "union(blend: 0.1) { sphere(radius: 0.5) sphere(radius: 0.5).translate([3, 0, 0]) }",
    "shell": "sphere(radius: 0.495).shell(0.01)",
    "bore": "box(size: [1.6, 1.6, 1]) - cylinder(radius: 0.5, height: 3).rotate(z: 90deg)",
}
_NEAR = range(1, 8)  # h = r (1 +- 10^-k)
_LINE = (3, 65)  # rays above each other

_CORNERED = {
    "box": ("box(size: [1, 1, 1])", (0.5, 0.5, 0.5)),
    "octahedron": ("octahedron(radius: 0.6).rotate(y: 20deg)", (0.0, 0.6, 0.0)),
    "wedge": ("wedge(size: [1, 1, 1])", (0.5, 0.5, 0.5)),
    "pyramid": ("pyramid()", (0.0, 0.5, 0.0)),
    "prism": ("prism(sides: 5, radius: 0.5, height: 0.8)", (0.5, 0.0, 0.4)),
    "cut box": ("box(size: [1, 1, 1]) - box(size: [1, 1, 1]).translate([0.5, 0.5, 0.5])", ORIGIN),
    "box and ball": ("box(size: [1, 1, 1]) & sphere(radius: 0.7)", (0.5, 0.489897948556636, 0.0)),
    "twisted box": ("box(size: [1, 1, 1]).twist(30deg)", (0.5, 0.0, 0.5)),
    "frame": ("box_frame(edge: 0.1)", (0.5, 0.5, 0.5)),
    "extruded star": ("star().extrude(height: 0.4)", (0.0, 0.5, 0.2)),
}
_DEAR = frozenset({"extruded star"})  # whose truth takes long: seen from ahead only
_DIAGONALS: tuple[Point, ...] = ((1.0, 1.0, 1.0), (0.0, 1.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.2, 0.0))

_AXES: dict[str, Point] = {
    "+x": (4.0, 0.0, 0.0),
    "-x": (-4.0, 0.0, 0.0),
    "+y": (0.0, 4.0, 0.0),
    "-y": (0.0, -4.0, 0.0),
    "+z": (0.0, 0.0, 4.0),
    "-z": (0.0, 0.0, -4.0),
}
_GROUPS = {
    "closed forms": (
        "box(size: [0.6, 0.6, 0.6]).translate([-0.7, 0.7, 0])",
        "cylinder(radius: 0.3, height: 0.6).translate([0.7, 0.7, 0])",
        "cone(radius: 0.3, height: 0.6).translate([-0.7, -0.7, 0])",
        "(tube(outer: 0.3, inner: 0.15, height: 0.6) - box(size: [0.2, 0.2, 2])).translate([0.7, -0.7, 0])",
        "octahedron(radius: 0.35)",
    ),
    "marched": (
        "torus(major: 0.25, minor: 0.1).translate([-0.7, 0.7, 0])",
        "rounded_box(size: [0.6, 0.6, 0.6], radius: 0.1).translate([0.7, 0.7, 0])",
        "union(blend: 0.1) { box(size: [0.6, 0.2, 0.2]) box(size: [0.2, 0.6, 0.2]) }.translate([-0.7, -0.7, 0])",
        "box_frame(size: [0.6, 0.6, 0.6], edge: 0.1).translate([0.7, -0.7, 0])",
        "sphere(radius: 0.3).shell(0.02)",
    ),
    "without end": (
        "plane(offset: -0.8)",
        "slab(thickness: 0.2, normal: [1, 0, 0])",
        "box(size: [0.5, 0.5, 0.5]).repeat(spacing: [1, 0, 1]) & box(size: [3.5, 1, 3.5])",
    ),
}

_SOLIDS = {  # with a point on the surface, and one inside
    "sphere": ("sphere(radius: 0.5)", (0.3, 0.4, 0.0), (0.1, 0.2, 0.0)),
    "box": ("box(size: [1, 1, 1])", (0.2, 0.5, 0.1), (0.1, 0.2, 0.3)),
    "torus": ("torus(major: 0.5, minor: 0.2)", (0.5, 0.2, 0.0), (0.5, 0.0, 0.0)),
    "rounded box": ("rounded_box(size: [1, 1, 1], radius: 0.1)", (0.5, 0.1, 0.2), ORIGIN),
    "blend": (
        "union(blend: 0.2) { sphere(radius: 0.4) sphere(radius: 0.3).translate([0.9, 0, 0]) }",
        (-0.4, 0.0, 0.0),
        (0.2, 0.0, 0.0),
    ),
    "hollow": ("sphere(radius: 0.6) - sphere(radius: 0.5)", (0.0, 0.0, 0.5), ORIGIN),
    "shell": ("box(size: [1, 1, 1]).shell(0.1)", (0.45, 0.0, 0.0), ORIGIN),
    "room": ("box(size: [2, 2, 2]) - rounded_box(size: [1.8, 1.8, 1.8], radius: 0.3)", (0.9, 0.0, 0.0), ORIGIN),
    "gyroid": ("gyroid(period: 0.8) & sphere(radius: 0.8)", (0.05, 0.05, 0.05), ORIGIN),
}
_DIRECTIONS: tuple[Point, ...] = ((1.0, 0.0, 0.0), (-0.3, 0.8, 0.5))

_POINTS = {  # where formulas divide zero by zero: apexes, axes, centres
    "sphere's centre": ("sphere(radius: 0.5)", ORIGIN),
    "cone's apex": ("cone(radius: 0.5, height: 1)", (0.0, 0.5, 0.0)),
    "cone's axis": ("cone(radius: 0.5, height: 1)", ORIGIN),
    "capped cone's axis": ("capped_cone(bottom: 0.5, top: 0, height: 1)", (0.0, 0.5, 0.0)),
    "cylinder's axis": ("cylinder(radius: 0.5, height: 1) - cylinder(radius: 0.2, height: 2)", ORIGIN),
    "torus' axis": ("torus(major: 0.5, minor: 0.2)", ORIGIN),
    "torus' circle": ("torus(major: 0.5, minor: 0.2)", (0.5, 0.0, 0.0)),
    "ellipsoid's centre": ("ellipsoid(radii: [0.6, 0.4, 0.3])", ORIGIN),
    "superellipsoid's centre": ("superellipsoid(power: 4)", ORIGIN),
    "octahedron's apex": ("octahedron()", (0.0, 0.6, 0.0)),
    "paraboloid's apex": ("paraboloid()", (0.0, 0.5, 0.0)),
    "double cone's apex": ("quadric(square: [1, -1, 1], constant: 0) & box(size: [1, 1, 1])", ORIGIN),
    "hyperboloid's axis": ("hyperboloid()", ORIGIN),
    "round cone's axis": ("round_cone()", ORIGIN),
    "capsule's end": ("capsule()", (0.0, 0.5, 0.0)),
    "degenerate capsule": ("capsule(from: [0, 0, 0], to: [0, 0, 0], radius: 0.4)", ORIGIN),
    "revolved": ("circle(radius: 0.2).translate([0.4, 0]).revolve()", ORIGIN),
    "twisted": ("box().twist(90deg)", ORIGIN),
    "kaleidoscope": ("box(size: [0.3, 0.3, 0.3]).translate([0.5, 0, 0]).mirror_polar_repeat(count: 6)", ORIGIN),
    "seam": ("sphere(radius: 0.5).seam(box(size: [0.8, 0.8, 0.8]), radius: 0.05)", (0.4, 0.3, 0.0)),
    "metaballs": ("metaballs()", (-0.35, 0.0, 0.0)),
    "capped torus": ("capped_torus()", ORIGIN),
    "solid angle": ("solid_angle()", ORIGIN),
    "lens": ("lens()", ORIGIN),
}


def _plus(a: Point, b: Point, times: float = 1.0) -> Point:
    return a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]


def _tangents(name: str, solid: str) -> tuple[Case, ...]:
    return tuple(
        Case(
            name=f"{name}, 1 +- 1e-{k}",
            text=scene(solid),
            view=parallel((0.01, 0.5, 4.0), (0.01, 0.5, 0.0), 2.0 * 0.5 * 10.0**-k),
            size=_LINE,
        )
        for k in _NEAR
    )


def _cornered(name: str, solid: str, corner: Point) -> tuple[Case, ...]:
    text = scene(solid)
    return tuple(
        Case(name=f"{name} from {way}", text=text, view=view, is_odd=True)
        for direction in (_DIAGONALS[2:3] if name in _DEAR else _DIAGONALS)
        for way, view in (
            (f"{direction}", look(_plus(corner, direction, 3.0), corner, 0.4)),
            (f"{direction} in parallel", parallel(_plus(corner, direction, 3.0), corner, 0.02)),
        )
    ) + tuple(
        Case(name=f"{name} exactly along {axis}", text=text, view=needle(corner, way), size=(1, 1))
        for axis, way in _AXES.items()
    )


def _started(name: str, solid: str, on: Point, within: Point) -> tuple[Case, ...]:
    return tuple(
        Case(name=f"{where} {name}, to {d}", text=scene(solid), view=look(point, _plus(point, d), 1.2), is_odd=True)
        for where, point in (("on", on), ("within", within))
        for d in _DIRECTIONS
    )


def _through(name: str, solid: str, point: Point) -> tuple[Case, ...]:
    text = scene(solid)
    return (
        Case(name=name, text=text, view=look(_plus(point, (1.3, 0.9, 2.0)), point), is_odd=True),
        Case(name=f"{name} from above", text=text, view=look(_plus(point, (0.0, 3.0, 0.0)), point), is_odd=True),
        *(
            Case(name=f"{name} exactly along {axis}", text=text, view=needle(point, way), size=(1, 1))
            for axis, way in _AXES.items()
        ),
    )


_BOWL = "(sphere(radius: 1) - sphere(radius: 0.99)) & plane(normal: [0, 0, 1], offset: 0.3)"
_ENDS = (
    Case(name="a bowl's wall", text=scene(_BOWL), view=look((0.1, 0.2, 3.0), fov=0.7)),
    Case(
        name="a ball at the far end",
        text=scene("sphere(radius: 0.05).translate([0, 0, -1])", "sphere(radius: 0.05).translate([0, 0.3, 1])"),
        view=look((0.0, 0.1, 4.0), (0.0, 0.0, -1.0), 0.05),
    ),
    Case(
        name="a wall seen from the middle of a shell",
        text=scene("sphere(radius: 1).shell(0.001)"),
        view=look(ORIGIN, (1, 2, 3)),
    ),
    Case(
        name="a thin sheet at the end",
        text=scene("box(size: [2, 2, 0.001]).translate([0, 0, -1])", "box(size: [0.1, 0.1, 0.1]).translate([0, 0, 1])"),
        view=look((0.3, 0.4, 2.0), (0.0, 0.0, -1.0), 0.7),
    ),
    Case(
        name="a torus as large as the scene",
        text=scene("torus(major: 1, minor: 0.02)"),
        view=look((0.4, 0.6, 2.5), fov=0.7),
    ),
    Case(
        name="the horizon of a floor",
        text=scene("plane()", "sphere(radius: 0.5)"),
        view=look((0.0, 1.0, 4.0), (0.0, 1.0, 0.0), 0.3),
    ),
    Case(
        name="the horizon of a marched floor",
        text=scene("waves(amplitude: 0.1, wavelength: 3)", "sphere(radius: 0.5)"),
        view=look((0.0, 1.0, 4.0), (0.0, 0.9, 0.0), 0.3),
    ),
)

FAMILIES = (
    Family(
        name="tangent",
        doc="Rays that pass a round solid at r (1 +- 10^-k): hit or miss by the last digits.",
        cases=tuple(case for name, solid in _ROUND.items() for case in _tangents(name, solid)),
    ),
    Family(
        name="edge",
        doc="Rays through corners, along edges and within faces.",
        cases=tuple(case for name, (solid, corner) in _CORNERED.items() for case in _cornered(name, solid, corner)),
    ),
    Family(
        name="axis",
        doc="Rays parallel to the axes: two components of their directions are zero.",
        cases=tuple(
            Case(name=f"{group} along {axis}", text=scene(*solids), view=parallel(eye), is_odd=True)
            for group, solids in _GROUPS.items()
            for axis, eye in _AXES.items()
        ),
    ),
    Family(
        name="start",
        doc="The eye on a surface, or inside a solid, or in a hollow.",
        cases=tuple(case for name, given in _SOLIDS.items() for case in _started(name, *given)),
    ),
    Family(
        name="far",
        doc="Surfaces just before the end of what is searched, where a step too long ends beyond it.",
        cases=_ENDS,
    ),
    Family(
        name="nan",
        doc="Rays exactly through points where formulas are 0/0: apexes, axes, centres.",
        cases=tuple(case for name, (solid, point) in _POINTS.items() for case in _through(name, solid, point)),
    ),
)
