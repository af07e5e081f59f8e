"""The convex hull of points in space, with exact predicates: no arrangement of points can break it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sdfc.openscad.space import Point

Integers: TypeAlias = tuple[int, int, int]
Plane: TypeAlias = tuple[Point, float]  # unit normal n and offset d: inside where n . p <= d

GRID_BITS = 36  # points are snapped to extent / 2^36, far below the six digits of a .csg file
SAME_DIRECTION = 1e-10  # normals whose cosine is this near 1 (1.4e-5 rad) belong to one face
SLIVER = 1e-6  # a face thinner than this part of the extent is the rounding of the file


@dataclass(frozen=True, slots=True)
class Polytope:
    """A convex solid with flat faces: its corners and its planes. Every corner is on or under every plane."""

    corners: tuple[Point, ...]
    planes: tuple[Plane, ...]


def hull(points: Sequence[Point]) -> Polytope | None:
    """The smallest convex solid with these points; None where they lie in one plane."""
    if len(points) < 4:
        return None
    extent = max(max(p[axis] for p in points) - min(p[axis] for p in points) for axis in range(3))
    if not extent > 0.0:
        return None
    step = math.ldexp(1.0, math.frexp(extent)[1] - GRID_BITS)
    origin = points[0]
    snapped: dict[Integers, Point] = {}
    for p in points:
        x, y, z = (round((c - o) / step) for c, o in zip(p, origin, strict=True))
        snapped.setdefault((x, y, z), p)
    return _Quickhull(list(snapped), list(snapped.values()), extent / step).result()


def _minus(a: Integers, b: Integers) -> Integers:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Integers, b: Integers) -> Integers:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Integers, b: Integers) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@dataclass(slots=True, eq=False)
class _Face:
    """A triangle, counter-clockwise seen from outside; the points above it wait to be added."""

    corners: tuple[int, int, int]
    normal: Integers
    offset: int
    above: list[int]

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        a, b, c = self.corners
        return (a, b), (b, c), (c, a)


class _Quickhull:
    """Barber, Dobkin and Huhdanpaa (1996), on integers, so that "above a plane" is always answered right."""

    def __init__(self, grid: list[Integers], points: list[Point], extent: float) -> None:
        self.grid = grid
        self.points = points
        self.extent = extent
        self.across: dict[tuple[int, int], _Face] = {}  # by directed edge

    def result(self) -> Polytope | None:
        first = self._simplex()
        if first is None:
            return None
        waiting = self._begin(first)
        while waiting:
            face = waiting.pop()
            if face.above and self.across.get(face.edges[0]) is face:
                waiting.extend(self._grow(face))
        return self._merged()

    def _simplex(self) -> tuple[int, int, int, int] | None:
        """Four points that span space, the fourth under the triangle of the others."""
        grid, every = self.grid, range(len(self.grid))
        a, b = min(every, key=grid.__getitem__), max(every, key=grid.__getitem__)
        along = _minus(grid[b], grid[a])

        def off_line(i: int) -> int:
            n = _cross(along, _minus(grid[i], grid[a]))
            return _dot(n, n)

        c = max(every, key=off_line)
        normal = _cross(along, _minus(grid[c], grid[a]))

        def height(i: int) -> int:
            return _dot(normal, _minus(grid[i], grid[a]))

        d = max(every, key=lambda i: abs(height(i)))
        if height(d) == 0:
            return None
        return (a, b, c, d) if height(d) < 0 else (b, a, c, d)

    def _face(self, a: int, b: int, c: int) -> _Face:
        origin = self.grid[a]
        normal = _cross(_minus(self.grid[b], origin), _minus(self.grid[c], origin))
        face = _Face((a, b, c), normal, _dot(normal, origin), [])
        for edge in face.edges:
            self.across[edge] = face
        return face

    def _assign(self, faces: list[_Face], candidates: Sequence[int]) -> None:
        for i in candidates:
            p = self.grid[i]
            for face in faces:
                if _dot(face.normal, p) > face.offset:
                    face.above.append(i)
                    break

    def _begin(self, simplex: tuple[int, int, int, int]) -> list[_Face]:
        a, b, c, d = simplex
        faces = [self._face(a, b, c), self._face(a, d, b), self._face(b, d, c), self._face(c, d, a)]
        self._assign(faces, range(len(self.grid)))
        return faces

    def _grow(self, face: _Face) -> list[_Face]:
        """Adds the farthest point above a face; the new faces."""
        top = max(face.above, key=lambda i: _dot(face.normal, self.grid[i]))
        p = self.grid[top]
        seen, visible, horizon = {id(face)}, [face], []
        for near in visible:  # grows as it is read
            for u, v in near.edges:
                beyond = self.across[v, u]
                if id(beyond) in seen:
                    continue
                if _dot(beyond.normal, p) > beyond.offset:
                    seen.add(id(beyond))
                    visible.append(beyond)
                else:
                    horizon.append((u, v))
        for gone in visible:
            for edge in gone.edges:
                del self.across[edge]
        made = [self._face(u, v, top) for u, v in horizon]
        self._assign(made, [i for gone in visible for i in gone.above if i != top])
        return made

    def _merged(self) -> Polytope:
        """Coplanar triangles as one plane; a plane always touches its farthest corner."""
        alive = [face for edge, face in self.across.items() if edge == face.edges[0]]
        corners = tuple(self.points[i] for i in sorted({i for face in alive for i in face.corners}))
        planes = []
        for group in self._groups(alive):
            if all(self._is_sliver(face) for face in group):
                continue
            total = [math.fsum(float(face.normal[axis]) for face in group) for axis in range(3)]
            length = math.hypot(*total)
            normal = (total[0] / length, total[1] / length, total[2] / length)
            touched = corners if len(group) > 1 else [self.points[i] for i in group[0].corners]
            planes.append((normal, max(normal[0] * x + normal[1] * y + normal[2] * z for x, y, z in touched)))
        return Polytope(corners, tuple(planes))

    def _is_sliver(self, face: _Face) -> bool:
        longest = max(math.dist(self.grid[u], self.grid[v]) for u, v in face.edges)
        return math.hypot(*map(float, face.normal)) < SLIVER * self.extent * longest

    def _groups(self, alive: list[_Face]) -> list[list[_Face]]:
        """Faces joined across edges where their normals agree."""
        unit = {id(face): _unit(face.normal) for face in alive}
        groups, done = [], set()
        for start in sorted(alive, key=lambda f: -math.hypot(*map(float, f.normal))):  # the largest gives the direction
            if id(start) in done:
                continue
            done.add(id(start))
            group, stack, direction = [start], [start], unit[id(start)]
            while stack:
                for u, v in stack.pop().edges:
                    near = self.across[v, u]
                    agrees = sum(a * b for a, b in zip(unit[id(near)], direction, strict=True)) > 1.0 - SAME_DIRECTION
                    if agrees and id(near) not in done:
                        done.add(id(near))
                        group.append(near)
                        stack.append(near)
            groups.append(group)
        return groups


def _unit(v: Integers) -> Point:
    length = math.hypot(*map(float, v))
    return v[0] / length, v[1] / length, v[2] / length
