"""How much an affine map stretches: the singular values that turn a child's distance into a bound."""

from __future__ import annotations

import math

from sdfc.field.graph import Expr, Op, topological
from sdfc.shape.matrix import Matrix

_SAMPLES = (0.137, 0.731, -1.913, 2.618)  # any numbers: an identity between analytic functions holds at all or fails at some


def singular_values(rows: list[list[float]]) -> list[float]:
    """Of a 3x3 matrix, smallest first, by cyclic Jacobi rotations of M^T M."""
    m = [[sum(rows[k][i] * rows[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    for _ in range(30):
        if max(abs(m[0][1]), abs(m[0][2]), abs(m[1][2])) <= 1e-17 * (m[0][0] + m[1][1] + m[2][2]):
            break
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if m[i][j] == 0.0:
                continue
            theta = 0.5 * math.atan2(2 * m[i][j], m[j][j] - m[i][i])
            c, s = math.cos(theta), math.sin(theta)
            for k in range(3):  # columns, then rows
                m[k][i], m[k][j] = c * m[k][i] - s * m[k][j], s * m[k][i] + c * m[k][j]
            for k in range(3):
                m[i][k], m[j][k] = c * m[i][k] - s * m[j][k], s * m[i][k] + c * m[j][k]
    return sorted(math.sqrt(max(m[i][i], 0.0)) for i in range(3))


def _numbers(matrix: Matrix) -> list[list[float]]:
    return [[e.number for e in row] for row in matrix.linear]


def _sampled(matrix: Matrix, shift: float) -> list[list[float]]:
    """The linear part at one choice of the params."""
    entries = [e for row in matrix.linear for e in row]
    values: dict[int, Expr] = {}
    for node in topological(entries):
        if node.op is Op.PARAM:
            numbers = [shift * (1 + 0.1 * i) + 0.01 * (hash_of(str(node.value)) + i) for i in range(node.type.size)]
            values[node.id] = node.graph.constant(*numbers)
        else:
            args = tuple(values[a.id] for a in node.args)
            values[node.id] = node.graph.add(node.op, *args, value=node.value) if args else node
    flat = [values[e.id].number for e in entries]
    return [flat[0:3], flat[3:6], flat[6:9]]


def hash_of(name: str) -> int:
    """A small number from a name, the same in every run."""
    return sum(ord(c) * (i + 1) for i, c in enumerate(name)) % 97


def _in_space(matrix: Matrix, dimension: int) -> Matrix:
    """A map of the plane as one of space with the same stretches: the third axis gets the first's."""
    if dimension == 3:
        return matrix
    graph = matrix.offset[0].graph
    first, second, (a, b, _) = matrix.linear
    height = graph.length(graph.vector(first[0], second[0]))
    return Matrix((first, second, (a, b, height)), matrix.offset)


def is_similarity(matrix: Matrix, dimension: int = 3) -> bool:
    """Whether all directions stretch alike, for every value of the params."""
    matrix = _in_space(matrix, dimension)
    samples = [_numbers(matrix)] if matrix.is_constant else [_sampled(matrix, s) for s in _SAMPLES]
    return all(_is_similar(rows) for rows in samples)


def _is_similar(rows: list[list[float]]) -> bool:
    """Whether the columns are orthogonal and of one length, to rounding."""
    x, y, z = zip(*rows, strict=True)
    pairs = [math.fsum(a * b for a, b in zip(u, v, strict=True)) for u, v in ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))]
    size = pairs[0]
    return size > 0.0 and all(abs(p - q) <= 1e-12 * size for p, q in zip(pairs, (size, size, size, 0, 0, 0), strict=True))


def smallest_stretch(matrix: Matrix, dimension: int = 3) -> Expr:
    """A lower bound (exact for constants and similarities) of |M v| / |v|."""
    return _stretch(_in_space(matrix, dimension), 0)


def largest_stretch(matrix: Matrix, dimension: int = 3) -> Expr:
    """An upper bound (exact for constants and similarities) of |M v| / |v|."""
    return _stretch(_in_space(matrix, dimension), 2)


def _stretch(matrix: Matrix, which: int) -> Expr:
    graph = matrix.offset[0].graph
    columns = [graph.vector(*(row[j] for row in matrix.linear)) for j in range(3)]
    if is_similarity(matrix):
        if matrix.is_constant:
            return graph.constant(_rounded(math.hypot(*(row[0] for row in _numbers(matrix)))))
        lengths = {round(math.hypot(*(row[0] for row in _sampled(matrix, s))), 9) for s in _SAMPLES}
        return graph.constant(lengths.pop()) if len(lengths) == 1 else graph.length(columns[0])
    if matrix.is_constant:
        # a little outward: the singular values are square roots of rounded sums
        return graph.constant(singular_values(_numbers(matrix))[which] * (1 - 1e-9 if which == 0 else 1 + 1e-9))
    if which == 2:
        squares = [graph.dot(column, column) for column in columns]
        return graph.sqrt(squares[0] + squares[1] + squares[2])
    a, b, c = columns
    faces = [graph.cross(b, c), graph.cross(c, a), graph.cross(a, b)]
    volume = graph.abs(graph.dot(a, faces[0]))
    return volume / (graph.length(faces[0]) + graph.length(faces[1]) + graph.length(faces[2]))


def _rounded(value: float) -> float:
    """One, where only rounding keeps it from being one."""
    return 1.0 if abs(value - 1.0) < 1e-12 else value
