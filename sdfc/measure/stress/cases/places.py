"""Where things are, how large, and how far from the eye."""

from __future__ import annotations

from sdfc.measure.stress.record import Case, Family, Point, look, scene

# an edge, a curve that is no closed form, a blend: every kind of step
_THINGS = (
    "box(size: [1, 0.8, 0.9]) - sphere(radius: 0.55)",
    "torus(major: 0.5, minor: 0.12).rotate(x: 50deg).translate([0.9, 0.1, 0])",
    "union(blend: 0.2) { sphere(radius: 0.3) box(size: [0.9, 0.15, 0.2]) }.translate([-0.1, 0.75, 0])",
)
# thin, and marched within an intersection
_PLATE = "rounded_box(size: [1, 1, 0.004], radius: 0.002) - cylinder(radius: 0.2, height: 1).rotate(x: 90deg)"
_FLOOR = "plane(offset: -0.6)"
_GROUP = f"union {{ {' '.join(f'({thing})' for thing in _THINGS)} }}"
_EYE: Point = (2.1, 1.7, 2.9)
_FAR_OUT = (0.0, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6)


def _moved(by: float) -> Case:
    middle = (by, -0.7 * by, 0.3 * by)
    eye = (middle[0] + _EYE[0], middle[1] + _EYE[1], middle[2] + _EYE[2])
    return Case(
        name=f"moved by {by:g}",
        text=scene(f"{_GROUP}.translate([{middle[0]!r}, {middle[1]!r}, {middle[2]!r}])"),
        view=look(eye, middle, 0.8),
    )


def _scaled(by: float) -> Case:
    return Case(
        name=f"scaled by {by:g}",
        text=scene(f"{_GROUP}.scale({by!r})"),
        view=look((by * _EYE[0], by * _EYE[1], by * _EYE[2]), fov=0.8),
    )


def _seen_from(distance: float) -> tuple[Case, ...]:
    view = look((0.55 * distance, 0.45 * distance, 0.7 * distance), fov=min(0.8, 2.6 / distance))
    return (
        Case(name=f"seen from {distance:g}", text=scene(_GROUP), view=view),
        Case(name=f"a plate seen from {distance:g}", text=scene(_PLATE), view=view),
        Case(name=f"a plate and a floor seen from {distance:g}", text=scene(_PLATE, _FLOOR), view=view),
    )


def _beside(ratio: float) -> tuple[Case, Case]:
    """Beside a ball of radius `ratio`, from where all is seen and from close by."""
    ball = f"sphere(radius: {ratio!r}).translate([0, {-ratio!r}, 0])"
    text = scene(ball, "box(size: [1, 1, 1]).translate([0, 0.5, 0])", "torus(major: 0.5).translate([1.6, 0.2, 0])")
    return (
        Case(name=f"a ball {ratio:g} times larger", text=text, view=look((2.5 * ratio, ratio, 2.0 * ratio))),
        Case(name=f"close by a ball {ratio:g} times larger", text=text, view=look((3.0, 2.0, 3.5), (0.6, 0.4, 0.0))),
    )


FAMILIES = (
    Family(
        name="offset",
        doc="The scene far from the origin, and the eye with it: coordinates that have few digits left for the shape.",
        cases=tuple(_moved(by) for by in _FAR_OUT),
    ),
    Family(
        name="distance",
        doc="The eye far from the scene: the parameter of a hit is large, its last digit longer than what is seen.",
        cases=tuple(case for d in (1e1, 1e2, 1e3, 1e4, 1e5, 1e6) for case in _seen_from(d)),
    ),
    Family(
        name="scale",
        doc="Everything very small or very large: absolute epsilons show.",
        cases=tuple(_scaled(by) for by in (1e-4, 1e-2, 1.0, 1e2, 1e4)),
    ),
    Family(
        name="ratio",
        doc="Small things beside large ones: steps that the small need, distances that the large have.",
        cases=tuple(case for ratio in (1e1, 1e2, 1e3, 1e4, 1e5, 1e6) for case in _beside(ratio)),
    ),
)
