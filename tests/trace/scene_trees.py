"""Random scenes as text: every kind of step that the compiler can choose, in trees of hard operations."""

from __future__ import annotations

from hypothesis import strategies as st

# one word for what each is there for: its rule in the step tree
CLOSED = [
    "box(size: [0.9, 0.6, 1.1])",
    "sphere(radius: 0.55)",
    "cylinder(radius: 0.35, height: 1.3)",
    "cone(radius: 0.5, height: 1.2)",
    "capped_cone(bottom: 0.5, top: 0.2, height: 0.9)",
    "capsule(from: [-0.4, 0, 0.1], to: [0.5, 0.3, 0], radius: 0.22)",
    "ellipsoid(radii: [0.7, 0.4, 0.3])",
    "octahedron(radius: 0.7)",
    "prism(sides: 5, radius: 0.5, height: 0.8)",
    "slab(thickness: 0.3)",
    "wedge(size: [1, 0.8, 0.9])",
    "lens(radius: 0.6, thickness: 0.5)",
    "round_cone(bottom: 0.4, top: 0.2, height: 0.5)",
]
TWO_INTERVALS = [
    "hyperboloid(waist: 0.25, rim: 0.6, height: 1.2)",
    "quadric(square: [1, 1, -0.5], constant: -0.1) & box(size: [1.6, 1.6, 1.6])",
]
TANGENT = [
    "rounded_box(size: [0.9, 0.7, 1.1], radius: 0.12)",
    "box(size: [0.7, 0.5, 0.6]).round(0.13)",
    "superellipsoid(radii: [0.6, 0.5, 0.4], power: 4)",
    "rounded_cylinder(radius: 0.45, height: 0.9, rounding: 0.1)",
]
BALL = [
    "torus(major: 0.5, minor: 0.17)",
    "box(size: [0.5, 1.2, 0.5]).twist(50deg)",
    "box_frame(size: [1, 1, 1], edge: 0.12)",
    "sphere(radius: 0.5).shell(0.08)",
    "star(tips: 5, outer: 0.6, inner: 0.25).extrude(height: 0.4)",
    "sphere(radius: 0.45).displace(amplitude: 0.04, wavelength: 0.5)",
]
BLEND = [
    "union(blend: 0.25) { sphere(radius: 0.4) box(size: [1.1, 0.3, 0.3]) }",
    "union(blend: 0.2) { sphere(radius: 0.35).translate([-0.3, 0, 0]) sphere(radius: 0.3).translate([0.3, 0.1, 0])"
    " capsule(from: [0, -0.4, 0], to: [0, 0.4, 0], radius: 0.15) }",
    "intersection(blend: 0.15) { box(size: [1, 0.8, 0.8]) sphere(radius: 0.55) }",
    "difference(blend: 0.1) { sphere(radius: 0.6) cylinder(radius: 0.25, height: 2) }",
]
KINDS = {"closed": CLOSED, "two intervals": TWO_INTERVALS, "tangent": TANGENT, "ball": BALL, "blend": BLEND}

NUMBERS = st.integers(-9, 9).map(lambda n: n / 10)
ANGLES = st.sampled_from([0, 15, 30, 45, 90, 120, 200])


def table(count: int, seed: int) -> str:
    """More than 48 spheres of one union: rows of a table."""
    return (
        f"union(for i in 0..{count}: sphere(radius: 0.05 + 0.03 * fract(0.37 * i + 0.1 * {seed})).translate("
        f"[1.6 * fract(0.7548 * i + 0.2 * {seed}) - 0.8, 1.6 * fract(0.5698 * i) - 0.8,"
        " 1.6 * fract(0.3247 * i) - 0.8]))"
    )


@st.composite
def leaves(draw: st.DrawFn, kinds: tuple[str, ...] = tuple(KINDS)) -> str:
    """A solid of one of the kinds, perhaps placed."""
    shape = draw(st.sampled_from(KINDS[draw(st.sampled_from(kinds))]))
    return draw(placed(f"({shape})"))


@st.composite
def placed(draw: st.DrawFn, shape: str) -> str:
    """The shape, moved by what may be drawn: turned, sheared, mirrored, stretched."""
    match draw(st.integers(0, 7)):
        case 0:
            return shape
        case 1:
            x, y, z = (draw(NUMBERS) for _ in range(3))
            return f"{shape}.translate([{x}, {y}, {z}])"
        case 2:
            return f"{shape}.rotate(x: {draw(ANGLES)}deg).rotate(z: {draw(ANGLES)}deg)"
        case 3:
            a, b, c = (draw(st.sampled_from([0.4, 0.8, 1.0, 1.5])) for _ in range(3))
            return f"{shape}.scale([{a}, {b}, {c}])"
        case 4:
            return f"{shape}.shear(xy: {draw(NUMBERS)}, zy: {draw(NUMBERS)})"
        case 5:
            return f"{shape}.mirror([1, {draw(NUMBERS)}, 0.3]).translate([0.2, {draw(NUMBERS)}, 0])"
        case _:
            return f"{shape}.rotate(y: {draw(ANGLES)}deg).translate([{draw(NUMBERS)}, {draw(NUMBERS)}, 0.1])"


@st.composite
def trees(draw: st.DrawFn, depth: int = 3) -> str:
    """A tree of hard unions, intersections, differences and complements."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        return draw(leaves())
    parts = [draw(trees(depth - 1)) for _ in range(draw(st.integers(2, 3)))]
    match draw(st.sampled_from(["union", "union", "difference", "difference", "intersection", "complement"])):
        case "union":
            return draw(placed(f"({' | '.join(parts)})"))
        case "difference":
            return draw(placed(f"({parts[0]} - ({' | '.join(parts[1:])}))"))
        case "intersection":
            return f"({' & '.join(parts)})"
        case _:
            return f"(box(size: [1.4, 1.4, 1.4]) & ~({' & '.join(parts)}))"


@st.composite
def scenes(draw: st.DrawFn) -> str:
    """A whole scene: a tree, perhaps a table of many, perhaps a floor."""
    parts = [draw(trees())]
    if draw(st.integers(0, 5)) == 0:
        parts.append(table(draw(st.sampled_from([49, 64, 70])), draw(st.integers(0, 5))))
    if draw(st.integers(0, 5)) == 0:
        parts.append("plane(normal: [0, 1, 0.1], offset: -0.9)")
    return "scene { " + " ".join(parts) + " }"
