"""Affine maps whose entries are expressions, so that a `param` may turn or move a part."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from sdfc.field.graph import Expr, FieldGraph, Op, Operand

Row: TypeAlias = tuple[Expr, Expr, Expr]
Linear: TypeAlias = tuple[Row, Row, Row]
Numbers: TypeAlias = tuple[float, ...]  # twelve: the linear part row by row, then the offset


@dataclass(frozen=True)
class Matrix:
    """p -> linear p + offset, in space. In the plane the third row and column are the identity's."""

    linear: Linear
    offset: Row

    @cached_property
    def entries(self) -> tuple[Expr, ...]:
        first, second, third = self.linear
        return (*first, *second, *third, *self.offset)

    @cached_property
    def numbers(self) -> Numbers | None:
        """The entries, where all are constants."""
        numbers: list[float] = []
        for entry in self.entries:
            if not entry.is_constant:
                return None
            numbers += entry.numbers
        return tuple(numbers)

    @property
    def is_constant(self) -> bool:
        return self.numbers is not None

    def after(self, first: Matrix) -> Matrix:
        """The map that does `first`, then this one."""
        if self.numbers is not None and first.numbers is not None:
            return matrix_of(self.offset[0].graph, composed(self.numbers, first.numbers))
        rows = [_combine(row, first.linear) for row in self.linear]
        moved = self.point(first.offset)
        return Matrix((rows[0], rows[1], rows[2]), moved)

    def tidied(self) -> Matrix:
        """For a rigid map: entries that only rounding keeps from -1, 0 or 1 are made exact."""
        first, second, third = ((_tidy(a), _tidy(b), _tidy(c)) for a, b, c in self.linear)
        return Matrix((first, second, third), self.offset)

    def point(self, p: Row) -> Row:
        """The image of a point given by components."""
        x, y, z = (_dot(row, p) + shift for row, shift in zip(self.linear, self.offset, strict=True))
        return x, y, z

    def apply(self, p: Expr) -> Expr:
        """The image of a point (VEC3 or VEC2)."""
        graph = p.graph
        scale = self._uniform_scale()
        if scale is not None:  # reads better than components: (p - centre) * scale
            size = p.type.size
            centre = graph.vector(*(-shift / scale for shift in self.offset[:size]))
            return (p - centre) * scale
        if p.type.size == 2:
            x, y, _ = self.point((p[0], p[1], graph.constant(0.0)))
            return graph.vector(x, y)
        return graph.vector(*self.point((p[0], p[1], p[2])))

    def _uniform_scale(self) -> Expr | None:
        """k where the linear part is k times the identity."""
        k = self.linear[0][0]
        for i, row in enumerate(self.linear):
            for j, entry in enumerate(row):
                if entry is not k if i == j else not (entry.is_constant and entry.number == 0.0):
                    return None
        return k

    def direction(self, d: Expr) -> Expr:
        """The image of a direction: without the offset."""
        graph = d.graph
        scale = self._uniform_scale()
        if scale is not None:
            return d * scale
        if d.type.size == 2:
            row: Row = (d[0], d[1], graph.constant(0.0))
            return graph.vector(*(_dot(r, row) for r in self.linear[:2]))
        return graph.vector(*(_dot(r, (d[0], d[1], d[2])) for r in self.linear))


def _tidy(entry: Expr) -> Expr:
    if not entry.is_constant or not abs(entry.number) <= 1.5:
        return entry
    nearest = float(round(entry.number))
    return entry.graph.constant(nearest) if abs(entry.number - nearest) < 1e-14 else entry


def composed(a: Numbers, b: Numbers) -> Numbers:
    """Of a after b, in plain numbers: scenes of thousands of parts compose mostly constants."""
    linear: list[float] = []
    offset: list[float] = []
    for i, shift in zip((0, 3, 6), a[9:], strict=True):
        x, y, z = a[i : i + 3]
        linear += (x * b[0] + y * b[3] + z * b[6], x * b[1] + y * b[4] + z * b[7], x * b[2] + y * b[5] + z * b[8])
        offset.append(x * b[9] + y * b[10] + z * b[11] + shift)
    return (*linear, *offset)


def matrix_of(graph: FieldGraph, numbers: Numbers) -> Matrix:
    """The constant map of these entries."""
    a, b, c, d, e, f, g, h, i, x, y, z = map(graph.constant, numbers)
    return Matrix(((a, b, c), (d, e, f), (g, h, i)), (x, y, z))


def _dot(a: Row, b: Row) -> Expr:
    total: Expr | None = None
    for x, y in zip(a, b, strict=True):
        factor = x.numbers[0] if x.is_constant else None
        if factor != 0.0 or y.is_constant:
            product = y if factor == 1.0 else x * y
            total = product if total is None else total + product
    return a[0] if total is None else total


def _combine(row: Row, matrix: tuple[Row, Row, Row]) -> Row:
    x, y, z = (_dot(row, (matrix[0][j], matrix[1][j], matrix[2][j])) for j in range(3))
    return x, y, z


def matrix(graph: FieldGraph, rows: list[list[Operand]], offset: list[Operand]) -> Matrix:
    """A matrix from nested lists of numbers or expressions (3x3 and 3)."""
    linear = tuple((graph.lift(a), graph.lift(b), graph.lift(c)) for a, b, c in rows)
    x, y, z = (graph.lift(o) for o in offset)
    return Matrix((linear[0], linear[1], linear[2]), (x, y, z))


def identity(graph: FieldGraph) -> Matrix:
    return scaling(graph, 1.0, 1.0, 1.0)


def scaling(graph: FieldGraph, x: Operand, y: Operand, z: Operand) -> Matrix:
    return matrix(graph, [[x, 0, 0], [0, y, 0], [0, 0, z]], [0, 0, 0])


def translation(graph: FieldGraph, x: Operand, y: Operand, z: Operand) -> Matrix:
    return matrix(graph, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [x, y, z])


def rotation(graph: FieldGraph, axis: int, angle: Expr) -> Matrix:
    """By `angle` (radians) about a coordinate axis (0, 1, 2), counter-clockwise seen from its tip."""
    c, s = _cosine_and_sine(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rows: list[list[Operand]] = [[1.0 if r == k else 0.0 for k in range(3)] for r in range(3)]
    rows[i][i], rows[i][j], rows[j][i], rows[j][j] = c, -s, s, c
    return matrix(graph, rows, [0, 0, 0])


def _cosine_and_sine(angle: Expr) -> tuple[Expr, Expr]:
    """Exact for constant quarter turns, where pi rounds."""
    graph = angle.graph
    if angle.is_constant:
        quarters = angle.number / (0.5 * math.pi)
        nearest = round(quarters) if math.isfinite(quarters) else 0
        if abs(quarters - nearest) < 1e-13 * max(1.0, abs(quarters)):
            c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[nearest % 4]
            return graph.constant(c), graph.constant(s)
    return graph.add(Op.COS, angle), graph.add(Op.SIN, angle)


def transposed(m: Matrix) -> Matrix:
    """The linear part's transpose, without offset: the inverse of a rotation."""
    zero = m.offset[0].graph.constant(0.0)
    columns = [(m.linear[0][j], m.linear[1][j], m.linear[2][j]) for j in range(3)]
    return Matrix((columns[0], columns[1], columns[2]), (zero, zero, zero))


def inverse(m: Matrix) -> Matrix:
    """The inverse map by the adjugate; its entries are not finite where the map is singular."""
    graph = m.offset[0].graph
    a, b, c = (graph.vector(*row) for row in m.linear)
    determinant = graph.dot(a, graph.cross(b, c))
    columns = [graph.cross(b, c) / determinant, graph.cross(c, a) / determinant, graph.cross(a, b) / determinant]
    rows = [(columns[0][i], columns[1][i], columns[2][i]) for i in range(3)]
    linear = (rows[0], rows[1], rows[2])
    back = [-_dot(row, m.offset) for row in linear]
    return Matrix(linear, (back[0], back[1], back[2]))
