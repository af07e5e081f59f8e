"""What spans the convex hull of a solid: points, balls and discs. Asked for only under `hull` and `minkowski`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias, assert_never

from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import SIMILAR, Map3, Point, cross, direction, dot, frame, moved_point, norm, similarity


@dataclass(frozen=True, slots=True)
class Generator:
    """A point (radius 0), a ball (no axis) or a disc (unit axis)."""

    center: Point
    radius: float = 0.0
    axis: Point | None = None

    def reach(self, axis: int) -> float:
        """How far it goes along a coordinate axis, to each side."""
        if self.axis is None:
            return self.radius
        return self.radius * math.sqrt(max(1.0 - self.axis[axis] ** 2, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Spanned:
    """Made when asked for. May refuse."""

    make: Callable[[], Sequence[Generator]] = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Faceted:
    """A round solid of few pieces: its corners, and the curve that they stand for."""

    corners: Callable[[], Sequence[Generator]] = field(repr=False)
    curve: Callable[[], Sequence[Generator]] = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Mapped:
    """Each generator of the child replaced by its image."""

    image: Callable[[Generator], Sequence[Generator]] = field(repr=False)
    child: Span3 = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Together:
    children: tuple[Span3, ...] = field(repr=False)


Span3: TypeAlias = Spanned | Faceted | Mapped | Together


def refused(message: str) -> Spanned:
    """For a solid whose hull is not known."""

    def make() -> Sequence[Generator]:
        raise RefusalError(message)

    return Spanned(make)


def generators(root: Span3, as_curves: bool = False) -> list[Generator]:
    """All of them, in order, each once; what has few pieces by its corners or as a curve. Iterative."""
    results: list[list[Generator]] = []
    stack: list[tuple[Span3, bool]] = [(root, False)]
    while stack:
        node, expanded = stack.pop()
        match node:
            case Spanned():
                results.append(list(node.make()))
            case Faceted():
                results.append(list(node.curve() if as_curves else node.corners()))
            case Mapped() if expanded:
                results.append([image for g in results.pop() for image in node.image(g)])
            case Mapped():
                stack += [(node, True), (node.child, False)]
            case Together() if expanded:
                count = len(node.children)
                parts = results[len(results) - count :]
                del results[len(results) - count :]
                results.append([g for part in parts for g in part])
            case Together():
                stack.append((node, True))
                stack.extend((child, False) for child in reversed(node.children))
            case _:
                assert_never(node)
    return list(dict.fromkeys(results[0]))


def moved(move: Map3, generator: Generator) -> Generator:
    """The image under an affine map, where it is a point, a ball or a disc again."""
    center = moved_point(move, generator.center)
    if generator.radius == 0.0:
        return Generator(center)
    if generator.axis is None:
        factor = similarity(move)
        if factor is None:
            raise RefusalError("the hull of a stretched ball has no exact form")
        return Generator(center, generator.radius * factor)
    return _moved_disc(move, generator, center, generator.axis)


def _moved_disc(move: Map3, disc: Generator, center: Point, axis: Point) -> Generator:
    u, v = frame(axis)
    a, b = direction(move, u), direction(move, v)
    if abs(norm(a) - norm(b)) > SIMILAR * norm(a) or abs(dot(a, b)) > SIMILAR * norm(a) * norm(b):
        raise RefusalError("the hull of a stretched disc has no exact form")
    normal = cross(a, b)
    size = norm(normal)
    return Generator(center, disc.radius * math.sqrt(size), (normal[0] / size, normal[1] / size, normal[2] / size))
