"""Solids of which little is left, or which meet where they should not."""

from __future__ import annotations

from sdfc.measure.stress.record import Case, Family, look, parallel, scene

_CORNER = look((2.3, 1.9, 2.9))
_THIN = (1e-2, 1e-4, 1e-5)

_SHELLS = {
    "cut ball": "(sphere(radius: 0.8) - sphere(radius: {inner})) - box(size: [2, 2, 2]).translate([1, 1, 1])",
    "ball's shell": "sphere(radius: 0.8).shell({thickness}) - box(size: [2, 2, 2]).translate([1, 1, 1])",
    "rounded box' shell": "rounded_box(radius: 0.2).shell({thickness}) - box(size: [2, 2, 2]).translate([1, 1, 1])",
    "plate": "box(size: [1.5, {thickness}, 1.5]).rotate(x: 40deg)",
    "tube": "tube(outer: 0.6, inner: {tube}, height: 1)",
    "wire": "torus(major: 0.7, minor: {thickness}).rotate(x: 50deg)",
}

_KERNELS = ("quadratic", "cubic", "circular", "exponential", "root", "round")
_WIDTHS = (0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2)
_OPERANDS = "box(size: [1, 0.5, 0.6]) sphere(radius: 0.4).translate([0.2, 0.3, 0.1])"

_BALL = "sphere(radius: 0.5)"
_BLOCK = "box(size: [1, 1, 1])"
_RING = "torus(major: 0.5, minor: 0.2)"
_SOFT = "rounded_box(radius: 0.1)"
_POST = "sphere(radius: 0.1).translate([0.8, 0, 0])"  # something to see where the rest is nothing

_EQUAL = {
    "a | a": ("{a} | {a}", _RING),
    "a & a": ("{a} & {a}", _SOFT),
    "a - a": ("({a} - {a}) | {post}", _BLOCK),
    "a - a, marched": ("({a} - {a}) | {post}", _RING),
    "a & ~a": ("({a} & ~({a})) | {post}", _BALL),
    "a & ~a, marched": ("({a} & ~({a})) | {post}", _SOFT),
    "a - (a - b)": ("{a} - ({a} - sphere(radius: 0.55))", _BLOCK),
    "a - (a - b), marched": ("{a} - ({a} - sphere(radius: 0.55))", _SOFT),
    "a blended with a": ("union(blend: 0.1) {{ {a} {a} }}", _BALL),
    "a blended with a, marched": ("union(blend: 0.1) {{ {a} {a} }}", _RING),
    "a bevelled with a": ("union(chamfer: 0.1) {{ {a} {a} }}", _BLOCK),
    "a & a, blended": ("intersection(blend: 0.1) {{ {a} {a} }}", _BLOCK),
    "a - a, blended": ("difference(blend: 0.1) {{ {a} {a} }} | {post}", _BALL),
    "a to a": ("morph({a}, {a}, 0.3)", _RING),
    "a, twice its complement": ("~~({a})", _BLOCK),
}

_FLUSH = {
    "a hole flush with both faces": f"{_BLOCK} - cylinder(radius: 0.3, height: 1)",
    "a pocket flush with the top": f"{_BLOCK} - cylinder(radius: 0.3, height: 0.5).translate([0, 0.25, 0])",
    "a corner cut flush on three sides": f"{_BLOCK} - box(size: [0.5, 0.5, 0.5]).translate([0.25, 0.25, 0.25])",
    "two blocks": f"{_BLOCK}.translate([-0.5, 0, 0]) | {_BLOCK}.translate([0.5, 0, 0])",
    "three tenths": " | ".join(f"box(size: [0.1, 1, 1]).translate([{0.1 * i!r}, 0, 0])" for i in range(3)),
    "two halves of a ball": f"({_BALL} & plane()) | ({_BALL} - plane())",
    "halves of a ring": f"({_RING} & plane()) | ({_RING} - plane())",
    "a soft block, flush hole": f"{_SOFT} - cylinder(radius: 0.3, height: 1)",
    "a twisted block, flush hole": f"{_BLOCK}.twist(40deg) - cylinder(radius: 0.3, height: 1)",
    "a ball in a block": f"{_BLOCK} - {_BALL}",
    "a ball that touches a floor": f"{_BALL}.translate([0, 0.5, 0]) | plane()",
    "blocks turned to each other": f"{_BLOCK}.rotate(y: 30deg) | ({_BLOCK}.translate([1, 0, 0]).rotate(y: 30deg))",
    "a cone on a cylinder": "cone(radius: 0.5, height: 0.6).translate([0, 0.3, 0])"
    " | cylinder(radius: 0.5, height: 0.5).translate([0, -0.25, 0])",
    "a blend flush with a block": f"union(blend: 0.1) {{ {_BLOCK} {_BLOCK}.translate([0.3, 0, 0]) }}",
}

_FLAT = ((1.0, 1.0, 0.01), (1.0, 0.01, 1.0), (1.0, 0.01, 0.01), (1.0, 0.1, 0.001), (1.0, 1.0, 0.0001))


def _shells() -> tuple[Case, ...]:
    return tuple(
        Case(
            name=f"{name}, {t:g} thick",
            text=scene(solid.format(thickness=f"{t!r}", inner=f"{0.8 - t!r}", tube=f"{0.6 - t!r}")),
            view=_CORNER,
        )
        for name, solid in _SHELLS.items()
        for t in _THIN
    )


def _blends(kernel: str) -> tuple[Case, ...]:
    text = scene(
        f"union(blend: k, kernel: {kernel}) {{ {_OPERANDS} }}",
        f"difference(blend: k, kernel: {kernel}) {{ {_OPERANDS} }}.translate([0, -1, 0])",
        before="param k = 0.1 in 0..0.1",
    )
    view = look((2.3, 1.5, 2.9), (0.0, -0.4, 0.0))
    return tuple(Case(name=f"{kernel}, {k:g}", text=text, view=view, params={"k": (k,)}) for k in _WIDTHS)


def _equals() -> tuple[Case, ...]:
    return tuple(
        Case(name=name, text=scene(pattern.format(a=solid, post=_POST)), view=_CORNER)
        for name, (pattern, solid) in _EQUAL.items()
    )


def _flush() -> tuple[Case, ...]:
    views = {
        "": _CORNER,
        " along z": parallel((0.0, 0.0, 4.0)),
        " along the face": look((4.0, 0.5, 0.3), (0.0, 0.5, 0.0), 0.5),
    }
    return tuple(
        Case(name=f"{name}{way}", text=scene(solid), view=view, is_odd=True)
        for name, solid in _FLUSH.items()
        for way, view in views.items()
    )


def _flats() -> tuple[Case, ...]:
    views = {
        "": look((1.5, 1.2, 2.5)),
        " from its edge": look((3.0, 0.003, 0.002), fov=0.7),
        " from its face": look((0.1, 0.05, 3.0), fov=0.7),
        " from above": look((0.02, 3.0, 0.1), fov=0.7),
    }
    return tuple(
        Case(name=f"{a:g} : {b:g} : {c:g}{way}", text=scene(f"ellipsoid(radii: [{a!r}, {b!r}, {c!r}])"), view=view)
        for a, b, c in _FLAT
        for way, view in views.items()
    )


FAMILIES = (
    Family(
        name="shell",
        doc="Walls from a tenth to 10^-5 of the scene: a step too long is on the other side.",
        cases=_shells(),
    ),
    Family(
        name="blend",
        doc="Blends whose width goes to zero: kernels divide by it.",
        cases=tuple(case for kernel in _KERNELS for case in _blends(kernel)),
    ),
    Family(name="equal", doc="Operands that are the same solid: differences that are exactly zero.", cases=_equals()),
    Family(name="flush", doc="Faces that coincide: films, cracks and speckle.", cases=_flush()),
    Family(
        name="ellipsoid",
        doc="Ellipsoids as flat as 1 : 1 : 0.0001: gradients of very different lengths.",
        cases=_flats(),
    ),
)
