"""Random expressions of the field graph."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from sdfc.field.graph import COMPARISON, Expr, FieldGraph, Op

UNARY = [Op.NEG, Op.ABS, Op.SIGN, Op.FLOOR, Op.ROUND, Op.SQRT, Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.ATAN]
UNARY += [Op.EXP, Op.LOG]
BINARY = [Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX, Op.MOD, Op.POW, Op.ATAN2]
NUMBERS = [0.0, 1.0, -1.0, 0.5, 2.0, -2.0, 3.0, 0.1, -0.3, math.pi / 2, 1e-3, 7.25, 1e6, -1e9, 1e-300, math.inf]


@st.composite
def expressions(draw: st.DrawFn, numbers: list[float] = NUMBERS, unary: list[Op] = UNARY) -> Expr:
    """A random FLOAT expression in p: about 4 to 15 operations over shared subexpressions of every type."""
    graph = FieldGraph()
    p = graph.input("p")
    scalars = [p[0], p[1], p[2], graph.constant(draw(st.sampled_from(numbers))), graph.param("k")]
    vectors = [p, graph.constant(*(draw(st.sampled_from(numbers)) for _ in range(3)))]
    for _ in range(draw(st.integers(3, 12))):
        a, b = draw(st.sampled_from(scalars)), draw(st.sampled_from(scalars))
        v, w = draw(st.sampled_from(vectors)), draw(st.sampled_from(vectors))
        match draw(st.integers(0, 8)):
            case 0 | 1:
                scalars.append(graph.add(draw(st.sampled_from(unary)), a))
            case 2 | 3:
                scalars.append(graph.add(draw(st.sampled_from(BINARY)), a, b))
            case 4:
                condition = graph.add(draw(st.sampled_from(sorted(COMPARISON, key=lambda op: op.value))), a, b)
                other = graph.add(draw(st.sampled_from([Op.AND, Op.OR])), condition, graph.add(Op.NOT, b < 1.0))
                scalars.append(graph.select(draw(st.sampled_from([condition, other])), a, b * 2.0))
            case 5:
                scalars.append(draw(st.sampled_from([graph.length(v), graph.dot(v, w), graph.dot(v, v), w[1]])))
            case 6:
                vectors.append(graph.add(draw(st.sampled_from(unary)), v))
            case 7:
                vectors.append(graph.add(draw(st.sampled_from(BINARY)), v, draw(st.sampled_from([w, a]))))
            case _:
                vectors.append(draw(st.sampled_from([graph.vector(a, b, a), w.swizzle("zxy"), graph.cross(v, w)])))
    return scalars[-1] if draw(st.booleans()) else graph.length(vectors[-1])
