"""Derivatives of field expressions, as field expressions: forward mode along a direction, reverse mode for gradients.

Both are linear in the size of the graph (Griewank and Walther 2008, chapter 3) and share one table of local partial
derivatives. At kinks they give one of the one-sided derivatives, which is a valid subgradient where one exists; where a
norm or a root has no derivative (length(0)) they give 0 or a large finite number, not NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from sdfc.field.component_extremes import Components, component_extremes
from sdfc.field.graph import COMPARISON, LEAVES, LOGIC, Expr, FieldGraph, Op, Type, topological

# Norms and roots are divided by no less than this: representable in float32, far below any length that matters.
TINY = 1e-30

# d node / d argument for each argument, for operations that work component by component; None is zero.
Partials: TypeAlias = Callable[[FieldGraph, Expr], tuple[Expr | None, ...]]


def directional(root: Expr, seeds: Mapping[Expr, Expr]) -> Expr:
    """The derivative of `root` when each key (an INPUT) moves at the rate that is its value; of the root's type."""
    return tangents(root, seeds)[root.id] or _zeros(root.graph, root.type)


def tangents(root: Expr, seeds: Mapping[Expr, Expr]) -> dict[int, Expr | None]:
    """The derivatives of all nodes below `root`, by id; None is zero."""
    graph = root.graph
    found: dict[int, Expr | None] = {}
    for node in topological([root]):
        if node in seeds:
            found[node.id] = _nonzero(_fit(seeds[node], node.type))
            continue
        given = [found[a.id] for a in node.args]
        tangent = None if all(t is None for t in given) else _tangent(graph, node, given)
        found[node.id] = None if tangent is None else _nonzero(_fit(tangent, node.type))
    return found


def gradient(root: Expr, point: Expr) -> Expr:
    """The gradient of the FLOAT `root` with respect to `point` (an INPUT): of the point's type."""
    assert root.type is Type.FLOAT, root.type
    graph = root.graph
    order = list(topological([root]))
    depending: set[int] = {point.id}
    for node in order:
        if any(a.id in depending for a in node.args):
            depending.add(node.id)
    extremes = component_extremes(order)
    if any(found.vector.op is Op.VECTOR for found in extremes.values()):
        # a vector made of the operands hands on what it gets from an extremum of them too: it is visited after that
        order = list(topological([root], lambda n: (extremes[n.id].vector,) if n.id in extremes else n.args))
    adjoints = _Adjoints(graph, depending)
    adjoints.add(root, graph.constant(1.0))
    for node in reversed(order):
        if node is point or node.id not in depending or node.op in LEAVES:
            continue
        adjoint = adjoints.total(node)
        if adjoint is None:
            continue
        if node.id in extremes:
            found = extremes[node.id]
            adjoints.add(found.vector, _chosen(adjoint, _unit(node, found)))
        else:
            _pull_back(graph, node, adjoint, adjoints)
    return adjoints.total(point) or _zeros(graph, point.type)


class _Adjoints:
    """The derivative of the root with respect to each node, summed as its users are visited."""

    def __init__(self, graph: FieldGraph, depending: set[int]) -> None:
        self._graph = graph
        self._depending = depending
        self._whole: dict[int, Expr] = {}
        self._parts: dict[int, list[Expr | None]] = {}

    def add(self, node: Expr, adjoint: Expr) -> None:
        """Adds a contribution of the node's type, or of a vector's type to a scalar that was spread over it."""
        if node.id not in self._depending or _is_zero(adjoint):
            return
        if adjoint.type.size > node.type.size:
            adjoint = self._graph.dot(adjoint, self._graph.constant(*([1.0] * adjoint.type.size)))
        adjoint = _fit(adjoint, node.type)
        before = self._whole.get(node.id)
        self._whole[node.id] = adjoint if before is None else before + adjoint

    def add_component(self, node: Expr, index: int, adjoint: Expr) -> None:
        if node.id not in self._depending or _is_zero(adjoint):
            return
        if node.type.size == 1:
            self.add(node, adjoint)
            return
        parts = self._parts.setdefault(node.id, [None] * node.type.size)
        before = parts[index]
        parts[index] = adjoint if before is None else before + adjoint

    def total(self, node: Expr) -> Expr | None:
        whole = self._whole.get(node.id)
        if node.id in self._parts:
            spread = self._graph.vector(*(0.0 if part is None else part for part in self._parts[node.id]))
            whole = spread if whole is None else whole + spread
        return None if whole is None else _nonzero(whole)


def _is_zero(e: Expr) -> bool:
    return e.is_constant and not any(e.numbers)


def _is_one(e: Expr) -> bool:
    return e.is_constant and e.numbers == (1.0,)


def _nonzero(e: Expr) -> Expr | None:
    return None if _is_zero(e) else e


def _zeros(graph: FieldGraph, type_: Type) -> Expr:
    return graph.constant(*([0.0] * type_.size))


def _fit(e: Expr, type_: Type) -> Expr:
    """A scalar spread over a vector type."""
    return e if e.type.size >= type_.size else e.graph.vector(*([e] * type_.size))


# ---- forward


def _tangent(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr | None:
    if node.op in _PARTIALS:
        terms = [
            partial * tangent
            for partial, tangent in zip(_PARTIALS[node.op](graph, node), given, strict=True)
            if partial is not None and tangent is not None
        ]
        return sum(terms[1:], terms[0]) if terms else None
    return _FORWARD[node.op](graph, node, given)


def _or_zeros(tangent: Expr | None, like: Expr) -> Expr:
    return _zeros(like.graph, like.type) if tangent is None else tangent


def _no_tangent(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> None:
    """Of leaves that are no seed, steps and conditions."""


def _forward_vector(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    return graph.vector(*(0.0 if t is None else t for t in given))


def _forward_swizzle(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    return graph.add(Op.SWIZZLE, _or_zeros(given[0], node.args[0]), value=node.value)


def _forward_dot(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    a, b = node.args
    if a is b:
        return 2.0 * graph.dot(a, _or_zeros(given[0], a))
    left = _zeros(graph, Type.FLOAT) if given[0] is None else graph.dot(given[0], b)
    return left if given[1] is None else left + graph.dot(a, given[1])


def _forward_length(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    v = node.args[0]
    return graph.dot(v, _or_zeros(given[0], v)) / graph.max(node, TINY)


def _forward_extremum(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    if node.type is Type.FLOAT:
        a, b = node.args
        return graph.select(_first_is_active(node), _or_zeros(given[0], a), _or_zeros(given[1], b))
    first = _first_weight(graph, node)
    weighted = [t * w for t, w in zip(given, (first, 1.0 - first), strict=True) if t is not None]
    return sum(weighted[1:], weighted[0])


def _forward_select(graph: FieldGraph, node: Expr, given: Sequence[Expr | None]) -> Expr:
    condition, then, otherwise = node.args
    return graph.select(condition, _or_zeros(given[1], then), _or_zeros(given[2], otherwise))


# ---- reverse


def _pull_back(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    if node.op in _PARTIALS:
        for argument, partial in zip(node.args, _PARTIALS[node.op](graph, node), strict=True):
            if partial is None:
                continue
            if argument.type.size < node.type.size == partial.type.size:
                adjoints.add(argument, graph.dot(adjoint, partial))
            elif partial.op is Op.DIV and _is_one(partial.args[0]):
                adjoints.add(argument, adjoint / partial.args[1])
            else:
                adjoints.add(argument, adjoint * partial)
    else:
        _REVERSE[node.op](graph, node, adjoint, adjoints)


def _no_adjoint(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    """Of leaves, steps and conditions."""


def _reverse_vector(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    for index, argument in enumerate(node.args):
        adjoints.add(argument, adjoint[index])


def _reverse_swizzle(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    assert isinstance(node.value, tuple)
    for index, target in enumerate(node.value):
        adjoints.add_component(node.args[0], int(target), adjoint[index])


def _reverse_dot(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    a, b = node.args
    if a is b:
        _to_components(a, a * (2.0 * adjoint), adjoints)
    else:
        adjoints.add(a, b * adjoint)
        adjoints.add(b, a * adjoint)


def _reverse_length(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    v, size = node.args[0], graph.max(node, TINY)
    _to_components(v, v / size if _is_one(adjoint) else v * (adjoint / size), adjoints)


def _to_components(v: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    """Adds an adjoint that is a multiple of v itself: to q where v, or a component of it, is max(q, 0) or min(q, 0),
    which is 0 wherever it is not q."""
    if v.op is Op.VECTOR and any(_cut_at_zero(a) is not a for a in v.args):
        for index, component in enumerate(v.args):
            adjoints.add(_cut_at_zero(component), adjoint[index])
    else:
        adjoints.add(_cut_at_zero(v), adjoint)


def _cut_at_zero(v: Expr) -> Expr:
    """q if v is max(q, 0) or min(q, 0), else v."""
    return v.args[0] if v.op in (Op.MIN, Op.MAX) and _is_zero(v.args[1]) and v.args[0].type is v.type else v


def _reverse_extremum(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    a, b = node.args
    if node.type is Type.FLOAT:
        first = _first_is_active(node)
        adjoints.add(a, graph.select(first, adjoint, 0.0))
        adjoints.add(b, graph.select(first, 0.0, adjoint))
    else:
        first = _first_weight(graph, node)
        adjoints.add(a, adjoint * first)
        adjoints.add(b, adjoint * (1.0 - first))


def _reverse_select(graph: FieldGraph, node: Expr, adjoint: Expr, adjoints: _Adjoints) -> None:
    condition, then, otherwise = node.args
    zeros = _zeros(graph, node.type)
    adjoints.add(then, graph.select(condition, adjoint, zeros))
    adjoints.add(otherwise, graph.select(condition, zeros, adjoint))


# ---- kinks


def _unit(node: Expr, extremum: Components) -> Expr:
    """The unit vector along the component that a scalar min or max takes; at a tie the last of them."""
    graph, operands = node.graph, extremum.operands
    size = extremum.vector.type.size
    units = [graph.constant(*[float(i == index) for i in range(size)]) for index in extremum.indices]
    if len(operands) == 2:
        return graph.select(_first_is_active(node), *units)
    chosen = units[0]
    for operand, unit in zip(operands[1:], units[1:], strict=True):
        chosen = graph.select(operand <= node if node.op is Op.MIN else node <= operand, unit, chosen)
    return chosen


def _chosen(factor: Expr, vector: Expr) -> Expr:
    """The product; where the factor is a choice with 0, a choice with a vector of zeros."""
    if factor.op is Op.SELECT and any(_is_zero(a) for a in factor.args[1:]):
        condition, then, otherwise = factor.args
        return vector.graph.select(condition, vector * then, vector * otherwise)
    return vector * factor


def _first_is_active(node: Expr) -> Expr:
    """Whether a scalar min or max takes its first argument."""
    a, b = node.args
    if b.is_constant:  # at a tie the side that moves: a box's normal must not vanish exactly on its face
        return a <= b if node.op is Op.MIN else b <= a
    return a < b if node.op is Op.MIN else b < a


def _first_weight(graph: FieldGraph, node: Expr) -> Expr:
    """1 in the components where a min or max takes its first argument, else 0 (conditions are scalars only)."""
    a, b = node.args
    ahead = b - a if node.op is Op.MIN else a - b
    return graph.max(graph.call(Op.SIGN, ahead), 0.0)


def _side(graph: FieldGraph, x: Expr) -> Expr:
    """-1 or 1, never 0: a normal must not vanish where |x| has its kink."""
    if x.type is Type.FLOAT:
        return graph.select(x < 0.0, -1.0, 1.0)
    return graph.call(Op.SIGN, graph.call(Op.SIGN, x) + 0.5)


# ---- the partial derivatives of what works component by component


def _power(graph: FieldGraph, node: Expr) -> tuple[Expr | None, ...]:
    x, y = node.args
    if not y.is_constant:
        base = graph.max(x, TINY)
        return y * graph.call(Op.POW, x, y - 1.0), node * graph.call(Op.LOG, base)
    if all(v == 2.0 for v in y.numbers):
        return y * x, None
    # below 1 the slope at 0 is infinite: guarded as a root is
    rooted = any(0.0 < v < 1.0 for v in y.numbers)
    return y * graph.call(Op.POW, graph.max(x, TINY) if rooted else x, y - 1.0), None


def _quotient(graph: FieldGraph, node: Expr) -> tuple[Expr | None, ...]:
    reciprocal = 1.0 / node.args[1]
    return reciprocal, -(node * reciprocal)


def _arc(graph: FieldGraph, node: Expr) -> Expr:
    x = node.args[0]
    return 1.0 / graph.sqrt(graph.max(1.0 - x * x, TINY))


def _angle(graph: FieldGraph, node: Expr) -> tuple[Expr | None, ...]:
    y, x = node.args
    square = graph.max(x * x + y * y, TINY)
    return x / square, -(y / square)


def _one(graph: FieldGraph) -> Expr:
    return graph.constant(1.0)


_PARTIALS: dict[Op, Partials] = {
    Op.NEG: lambda g, n: (-_one(g),),
    Op.ABS: lambda g, n: (_side(g, n.args[0]),),
    Op.SQRT: lambda g, n: (0.5 / g.max(n, TINY),),
    Op.SIN: lambda g, n: (g.call(Op.COS, n.args[0]),),
    Op.COS: lambda g, n: (-g.call(Op.SIN, n.args[0]),),
    Op.TAN: lambda g, n: (1.0 + n * n,),
    Op.ASIN: lambda g, n: (_arc(g, n),),
    Op.ACOS: lambda g, n: (-_arc(g, n),),
    Op.ATAN: lambda g, n: (1.0 / (1.0 + n.args[0] * n.args[0]),),
    Op.EXP: lambda g, n: (n,),
    Op.LOG: lambda g, n: (1.0 / n.args[0],),
    Op.ADD: lambda g, n: (_one(g), _one(g)),
    Op.SUB: lambda g, n: (_one(g), -_one(g)),
    Op.MUL: lambda g, n: (n.args[1], n.args[0]),
    Op.DIV: _quotient,
    Op.MOD: lambda g, n: (_one(g), -g.call(Op.FLOOR, n.args[0] / n.args[1])),
    Op.POW: _power,
    Op.ATAN2: _angle,
}

_STEPS = LEAVES | COMPARISON | LOGIC | {Op.SIGN, Op.FLOOR, Op.ROUND}

_FORWARD: dict[Op, Callable[[FieldGraph, Expr, Sequence[Expr | None]], Expr | None]] = {
    **dict.fromkeys(_STEPS, _no_tangent),
    Op.VECTOR: _forward_vector,
    Op.SWIZZLE: _forward_swizzle,
    Op.DOT: _forward_dot,
    Op.LENGTH: _forward_length,
    Op.MIN: _forward_extremum,
    Op.MAX: _forward_extremum,
    Op.SELECT: _forward_select,
}

_REVERSE: dict[Op, Callable[[FieldGraph, Expr, Expr, _Adjoints], None]] = {
    **dict.fromkeys(_STEPS, _no_adjoint),
    Op.VECTOR: _reverse_vector,
    Op.SWIZZLE: _reverse_swizzle,
    Op.DOT: _reverse_dot,
    Op.LENGTH: _reverse_length,
    Op.MIN: _reverse_extremum,
    Op.MAX: _reverse_extremum,
    Op.SELECT: _reverse_select,
}


def has_rule(op: Op) -> bool:
    """Whether both modes know the operation (tested for every one)."""
    return op in _PARTIALS or (op in _FORWARD and op in _REVERSE)
