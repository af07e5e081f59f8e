"""Random scenes as text: every kind of step that the compiler can choose, in trees of hard operations.

One grammar for all who draw: `sdfc stress --random` with a seed, and hypothesis in the tests.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import TypeVar

from sdfc.api.request import View
from sdfc.measure.stress.record import Case, Family, look, parallel

Item = TypeVar("Item")

# one word for what each is there for: its rule in the step tree
CLOSED = (
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
)
TWO_INTERVALS = (
    "hyperboloid(waist: 0.25, rim: 0.6, height: 1.2)",
    "quadric(square: [1, 1, -0.5], constant: -0.1) & box(size: [1.6, 1.6, 1.6])",
)
TANGENT = (
    "rounded_box(size: [0.9, 0.7, 1.1], radius: 0.12)",
    "box(size: [0.7, 0.5, 0.6]).round(0.13)",
    "superellipsoid(radii: [0.6, 0.5, 0.4], power: 4)",
    "rounded_cylinder(radius: 0.45, height: 0.9, rounding: 0.1)",
)
BALL = (
    "torus(major: 0.5, minor: 0.17)",
    "box(size: [0.5, 1.2, 0.5]).twist(50deg)",
    "box_frame(size: [1, 1, 1], edge: 0.12)",
    "sphere(radius: 0.5).shell(0.08)",
    "star(tips: 5, outer: 0.6, inner: 0.25).extrude(height: 0.4)",
    "sphere(radius: 0.45).displace(amplitude: 0.04, wavelength: 0.5)",
)
BLEND = (
    "union(blend: 0.25) { sphere(radius: 0.4) box(size: [1.1, 0.3, 0.3]) }",
    "union(blend: 0.2) { sphere(radius: 0.35).translate([-0.3, 0, 0]) sphere(radius: 0.3).translate([0.3, 0.1, 0])"
    " capsule(from: [0, -0.4, 0], to: [0, 0.4, 0], radius: 0.15) }",
    "intersection(blend: 0.15) { box(size: [1, 0.8, 0.8]) sphere(radius: 0.55) }",
    "difference(blend: 0.1) { sphere(radius: 0.6) cylinder(radius: 0.25, height: 2) }",
)
# Fields whose values are no distances. Their slopes are bounded everywhere, so that they may be blended and cut away;
# what is flat at its surface, and cut or blended, is in the family `flat`.
FLAT = ("thousandths()", "levelled()")
_FIELDS = """\
field thousandths() = 0.001 * (length(p * [1, 1.5, 2]) - 0.6) bounds -[0.61, 0.41, 0.31] .. [0.61, 0.41, 0.31]
field levelled() = d / (1 + 4 * abs(d)) where d = length(p) - 0.5
    lipschitz 1 bounds -[r, r, r] .. [r, r, r] where r = 0.5 + level / (1 - 4 * level)
"""
KINDS = {
    "closed": CLOSED,
    "two intervals": TWO_INTERVALS,
    "tangent": TANGENT,
    "ball": BALL,
    "blend": BLEND,
    "flat": FLAT,
}
KERNELS = ("quadratic", "cubic", "circular", "exponential", "root", "round")

VIEWS: tuple[View, ...] = (
    look((2.3, 1.9, 2.9)),
    look((-1.3, -2.9, 2.0), (0.1, 0.0, 0.0)),
    parallel((0.0, 0.0, 4.0), height=2.2),
    look((0.1, 0.05, 0.0), (1.0, 0.3, 0.2), 1.2),
)

_NUMBERS = tuple(n / 10 for n in range(-9, 10))
_ANGLES = (0, 15, 30, 45, 90, 120, 200)
_DEPTH = 3


def table(count: int, seed: int) -> str:
    """More than 48 spheres of one union: rows of a table."""
    return (
        f"union(for i in 0..{count}: sphere(radius: 0.05 + 0.03 * fract(0.37 * i + 0.1 * {seed})).translate("
        f"[1.6 * fract(0.7548 * i + 0.2 * {seed}) - 0.8, 1.6 * fract(0.5698 * i) - 0.8,"
        " 1.6 * fract(0.3247 * i) - 0.8]))"
    )


def whole(parts: Sequence[str]) -> str:
    """The scene of these parts, with the fields that they need."""
    shown = "scene { " + " ".join(parts) + " }"
    return _FIELDS + shown if any(field in shown for field in FLAT) else shown


class Grower:
    """Draws scenes. `pick` chooses one of several: all that is random about them."""

    def __init__(self, pick: Callable[[Sequence[object]], object]) -> None:
        self._pick = pick

    def pick(self, options: Sequence[Item]) -> Item:
        """One of them."""
        return self._pick(options)  # type: ignore[return-value]

    def scene(self) -> str:
        """A whole scene: a tree, perhaps a table of many, perhaps a floor."""
        parts = [self.tree()]
        if self.pick(range(6)) == 0:
            parts.append(table(self.pick((49, 64, 70)), self.pick(range(6))))
        if self.pick(range(6)) == 0:
            parts.append("plane(normal: [0, 1, 0.1], offset: -0.9)")
        return whole(parts)

    def tree(self, depth: int = _DEPTH) -> str:
        """A tree of hard unions, intersections, differences and complements."""
        if depth == 0 or self.pick(range(4)) == 0:
            return self.placed(f"({self._leaf()})")
        parts = [self.tree(depth - 1) for _ in range(self.pick((2, 3)))]
        match self.pick(("union", "union", "difference", "difference", "intersection", "complement", "blend")):
            case "blend":
                return self.placed(self.blended())
            case "union":
                return self.placed(f"({' | '.join(parts)})")
            case "difference":
                return self.placed(f"({parts[0]} - ({' | '.join(parts[1:])}))")
            case "intersection":
                return f"({' & '.join(parts)})"
            case _:
                return f"(box(size: [1.4, 1.4, 1.4]) & ~({' & '.join(parts)}))"

    def blended(self) -> str:
        """A smooth operation on two or three parts, of any kind."""
        operation = self.pick(("union", "union", "intersection", "difference"))
        kernel, width = self.pick(KERNELS), self.pick((0.02, 0.1, 0.3))
        parts = [self.placed(f"({self._leaf()})") for _ in range(self.pick((2, 2, 3)))]
        return f"{operation}(blend: {width}, kernel: {kernel}) {{ {' '.join(parts)} }}"

    def _leaf(self) -> str:
        return self.pick(KINDS[self.pick(tuple(KINDS))])

    def _number(self) -> float:
        return self.pick(_NUMBERS)

    def placed(self, shape: str) -> str:
        """The shape, moved by what may be drawn: turned, sheared, mirrored, stretched."""
        match self.pick(range(8)):
            case 0:
                return shape
            case 1:
                return f"{shape}.translate([{self._number()}, {self._number()}, {self._number()}])"
            case 2:
                return f"{shape}.rotate(x: {self.pick(_ANGLES)}deg).rotate(z: {self.pick(_ANGLES)}deg)"
            case 3:
                a, b, c = (self.pick((0.4, 0.8, 1.0, 1.5)) for _ in range(3))
                return f"{shape}.scale([{a}, {b}, {c}])"
            case 4:
                return f"{shape}.shear(xy: {self._number()}, zy: {self._number()})"
            case 5:
                return f"{shape}.mirror([1, {self._number()}, 0.3]).translate([0.2, {self._number()}, 0])"
            case _:
                return (
                    f"{shape}.rotate(y: {self.pick(_ANGLES)}deg).translate([{self._number()}, {self._number()}, 0.1])"
                )


def grown(count: int, seed: int) -> Family:
    """A family of so many random scenes: the same ones for the same seed."""
    dice = random.Random(seed)
    grower = Grower(dice.choice)
    cases = [Case(name=f"{seed}-{i}", text=grower.scene(), view=dice.choice(VIEWS)) for i in range(count)]
    return Family(name="random", doc="Trees of everything, grown from a seed.", cases=tuple(cases))
