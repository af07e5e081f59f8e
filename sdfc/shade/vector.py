"""The few words of GLSL that shading formulas need beyond the field graph's own: each builds an expression."""

from sdfc.field.graph import Expr, Op, Operand

TINY = 1e-12
"""Keeps the length of a zero vector away from zero; its square root still means something in 32 bits."""


def mix(a: Expr, b: Expr, t: Expr) -> Expr:
    """`a` at t = 0, `b` at t = 1."""
    return a + (b - a) * t


def saturate(x: Expr) -> Expr:
    """`x` brought into [0, 1]."""
    return x.graph.clamp(x, 0.0, 1.0)


def square(x: Expr) -> Expr:
    """x²."""
    return x * x


def fifth_power(x: Expr) -> Expr:
    """x⁵, by products: `pow` says nothing of a negative base."""
    return square(square(x)) * x


def power(base: Expr, exponent: Operand) -> Expr:
    """`base` (not negative) to `exponent`; zero is lifted a little, of which GLSL's pow says nothing."""
    graph = base.graph
    return graph.call(Op.POW, graph.max(base, 1e-7), exponent)


def exponential(x: Expr) -> Expr:
    """eˣ."""
    return x.graph.call(Op.EXP, x)


def normalize(x: Expr) -> Expr:
    """The unit vector along `x`; the zero vector stays zero."""
    graph = x.graph
    return x / graph.sqrt(graph.max(graph.dot(x, x), TINY))


def reflect(view: Expr, normal: Expr) -> Expr:
    """The direction in which what arrives at the viewer left a mirror: `view` (towards the viewer), mirrored."""
    return normal * (2.0 * view.graph.dot(view, normal)) - view


def polynomial(x: Expr, coefficients: tuple[float, ...]) -> Expr:
    """Σ coefficients[i] xⁱ, by Horner's rule."""
    result = x.graph.lift(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        result = result * x + coefficient
    return result


def luminance(color: Expr) -> Expr:
    """The brightness of a linear colour (Rec. 709)."""
    return color.graph.dot(color, color.graph.constant(0.2126, 0.7152, 0.0722))
