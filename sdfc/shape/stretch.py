"""How much an affine map stretches: the singular values that turn a child's distance into a bound."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias, TypeVar

from sdfc.field.folding import fold
from sdfc.field.graph import COMPARISON, LOGIC, Expr, FieldGraph, Op, topological
from sdfc.shape.matrix import Matrix

Rows: TypeAlias = Sequence[Sequence[float]]
Entries: TypeAlias = tuple[tuple[Expr, ...], ...]
T = TypeVar("T")

# What is not analytic is a variable of its own: an identity that holds whatever its value is holds for the real one.
_JUMPS = frozenset({Op.ABS, Op.SIGN, Op.FLOOR, Op.ROUND, Op.MIN, Op.MAX, Op.MOD, Op.SELECT}) | COMPARISON | LOGIC
_FREE = _JUMPS | {Op.PARAM}
_SIZES = (0.7, 3.1, 0.23, 11.0, 1.9, 41.0)  # of the variables, by sample; every other sample has none below 0
_ENOUGH = 3  # samples with finite entries
_ROUNDING = 1e-12
_MARGIN = 1e-9  # outward: singular values are square roots of rounded sums


def is_similarity(matrix: Matrix, dimension: int = 3) -> bool:
    """Whether all directions stretch alike, for every value of the params."""
    rows = _linear(matrix, dimension)
    return _graph(matrix).remembered((is_similarity, rows), lambda: _always(rows, _is_similar))


def smallest_stretch(matrix: Matrix, dimension: int = 3) -> Expr:
    """A lower bound of |M v| / |v|; exact for constants, similarities and maps that keep the axes at right angles."""
    rows = _linear(matrix, dimension)
    return _graph(matrix).remembered((smallest_stretch, rows), lambda: _stretch(rows, is_largest=False))


def largest_stretch(matrix: Matrix, dimension: int = 3) -> Expr:
    """An upper bound of |M v| / |v|; exact for constants, similarities and maps that keep the axes at right angles."""
    rows = _linear(matrix, dimension)
    return _graph(matrix).remembered((largest_stretch, rows), lambda: _stretch(rows, is_largest=True))


def scale_of(rows: Rows) -> float | None:
    """The factor by which a map of plain numbers stretches all directions, or None where they differ."""
    factor = rows[0][0]
    if _entries(rows) == [factor if i == j else 0.0 for i in range(len(rows)) for j in range(len(rows))]:
        return abs(factor) if 0.0 < abs(factor) < math.inf else None  # most maps: nothing is turned
    columns = list(zip(*rows, strict=True))
    first = columns[0]
    square = _dot(first, first)
    slack = _ROUNDING * square
    for j, column in enumerate(columns[1:], 1):
        if abs(_dot(column, column) - square) > slack or any(abs(_dot(column, c)) > slack for c in columns[:j]):
            return None
    return _rounded(math.sqrt(square)) if 0.0 < square < math.inf else None


def singular_values(rows: Rows) -> list[float]:
    """Of a square matrix, smallest first, by one-sided Jacobi rotations (Hestenes 1958): small ones are right, too."""
    columns = [list(column) for column in zip(*rows, strict=True)]
    pairs = [(i, j) for j in range(len(columns)) for i in range(j)]
    for _ in range(40):
        rotated = [_rotated(columns[i], columns[j]) for i, j in pairs]
        if not any(rotated):
            break
    return sorted(math.hypot(*column) for column in columns)


def _rotated(a: list[float], b: list[float]) -> bool:
    """Make two columns orthogonal; False where they are."""
    off = _dot(a, b)
    sizes = math.hypot(*a) * math.hypot(*b)
    if abs(off) <= 1e-15 * sizes or sizes == 0.0:
        return False
    ratio = (_dot(b, b) - _dot(a, a)) / (2.0 * off)
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.hypot(1.0, ratio))
    c = 1.0 / math.hypot(1.0, tangent)
    s = c * tangent
    for k, (x, y) in enumerate(zip(a, b, strict=True)):
        a[k], b[k] = c * x - s * y, s * x + c * y
    return True


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    total = 0.0
    for x, y in zip(a, b, strict=True):
        total += x * y
    return total


def _graph(matrix: Matrix) -> FieldGraph:
    return matrix.offset[0].graph


def _linear(matrix: Matrix, dimension: int) -> Entries:
    return matrix.linear if dimension == 3 else tuple([row[:dimension] for row in matrix.linear[:dimension]])


def _entries(rows: Sequence[Sequence[T]]) -> list[T]:
    return [entry for row in rows for entry in row]


def _transposed(rows: Rows) -> Rows:
    return list(zip(*rows, strict=True))


# --- what holds for all values of the params


def _always(rows: Entries, holds: Callable[[Rows], bool]) -> bool:
    samples = _samples(rows)
    return bool(samples) and all(map(holds, samples))


def _samples(rows: Entries) -> Sequence[Rows]:
    """The linear part: itself, or at some choices of the params (none where too few are defined)."""
    constant = _constant(rows)
    return [constant] if constant is not None else rows[0][0].graph.remembered((_samples, rows), lambda: _sampled(rows))


def _constant(rows: Entries) -> Rows | None:
    """The entries, where all are constants."""
    for row in rows:
        for entry in row:
            if not entry.is_constant:
                return None
    return [[entry.numbers[0] for entry in row] for row in rows]


def _sampled(rows: Entries) -> Sequence[Rows]:
    entries, dimension = _entries(rows), len(rows)
    order = topological(entries, lambda node: () if node.op in _FREE else node.args)
    sampled = [_numbers(order, entries, index) for index in range(len(_SIZES))]
    finite = [numbers for numbers in sampled if all(map(math.isfinite, numbers))]
    if len(finite) < _ENOUGH:
        return []
    return [[n[k : k + dimension] for k in range(0, dimension**2, dimension)] for n in finite]


def _numbers(order: Sequence[Expr], entries: Sequence[Expr], index: int) -> list[float]:
    """The entries where each variable has some value."""
    known: dict[Expr, tuple[float, ...]] = {}
    for node in order:
        if node.is_constant:
            known[node] = node.numbers
        elif node.op in _FREE:
            draws = [(0.618034 * (len(known) + 1) + 0.445042 * k + 0.147 * index) % 1.0 for k in range(node.type.size)]
            known[node] = tuple([_SIZES[index] * (0.05 + d if index % 2 else 2.0 * d - 1.0) for d in draws])
        else:
            known[node] = fold(node.op, [known[a] for a in node.args], node.type.size, node.value)
    return [known[e][0] for e in entries]


def _is_similar(rows: Rows) -> bool:
    return scale_of(rows) is not None


def _are_orthogonal(rows: Rows) -> bool:
    """Whether the columns are at right angles, to rounding."""
    columns = list(zip(*rows, strict=True))
    return all(
        abs(_dot(a, b)) <= _ROUNDING * math.hypot(*a) * math.hypot(*b)
        for j, b in enumerate(columns)
        for a in columns[:j]
    )


# --- the bounds


def _stretch(rows: Entries, is_largest: bool) -> Expr:
    graph, dimension = rows[0][0].graph, len(rows)
    constant = _constant(rows)
    if constant is not None:
        return graph.constant(scale_of(constant) or _outward(singular_values(constant), is_largest))
    samples = _samples(rows)
    if samples and all(_is_similar(s) for s in samples):
        return _length_of_all(rows, samples)
    if samples and all(_are_orthogonal(s) for s in samples):
        return _extreme([_length([row[j] for row in rows]) for j in range(dimension)], is_largest)
    if samples and all(_are_orthogonal(_transposed(s)) for s in samples):
        return _extreme([_length(row) for row in rows], is_largest)
    norm = _norm(_entries(rows))
    if is_largest:
        return norm
    if dimension == 2:
        (a, b), (c, d) = rows
        return graph.abs(a * d - b * c) / norm
    first, second, third = (graph.vector(*row) for row in rows)
    faces = [graph.cross(second, third), graph.cross(third, first), graph.cross(first, second)]
    # the adjugate over the determinant is the inverse, whose Frobenius norm is no less than its largest stretch
    volume = graph.abs(graph.dot(first, faces[0]))
    return volume / _norm([face[k] for face in faces for k in range(3)])


def _outward(values: list[float], is_largest: bool) -> float:
    return values[-1] * (1 + _MARGIN) if is_largest else values[0] * (1 - _MARGIN)


def _length_of_all(rows: Sequence[Sequence[Expr]], samples: Sequence[Rows]) -> Expr:
    """The one length that the columns of a similarity have: a number where it is always the same."""
    sizes = [math.hypot(*[row[0] for row in sample]) for sample in samples]
    if max(sizes) - min(sizes) <= _ROUNDING * max(sizes):
        return rows[0][0].graph.constant(_rounded(sizes[0]))
    return _length([row[0] for row in rows])


def _length(entries: Sequence[Expr]) -> Expr:
    graph = entries[0].graph
    others = [e for e in entries if not (e.is_constant and e.number == 0.0)]
    return graph.abs(others[0]) if len(others) == 1 else graph.length(graph.vector(*entries))


def _norm(entries: Sequence[Expr]) -> Expr:
    graph = entries[0].graph
    total = graph.constant(0.0)
    for entry in entries:
        total = total + entry * entry
    return graph.sqrt(total)


def _extreme(lengths: Sequence[Expr], is_largest: bool) -> Expr:
    graph = lengths[0].graph
    result = lengths[0]
    for length in dict.fromkeys(lengths[1:]):
        result = graph.max(result, length) if is_largest else graph.min(result, length)
    return result


def _rounded(value: float) -> float:
    """One, where only rounding keeps it from being one."""
    return 1.0 if abs(value - 1.0) < _ROUNDING else value
