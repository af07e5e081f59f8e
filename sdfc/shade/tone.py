"""From light to what a screen shows: AgX (Sobotka 2022) in the polynomial form of Wrensch (2023), and sRGB's curve."""

from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Op, Type
from sdfc.shade.vector import luminance, mix, polynomial, power, saturate

INSET = (
    (0.842479062253094, 0.0784335999999992, 0.0792237451477643),
    (0.0423282422610123, 0.878468636469772, 0.0791661274605434),
    (0.0423756549057051, 0.0784336, 0.879142973793104),
)
"""Rows of the matrix that brings the primaries together, so that bright colours go to white and not to a primary."""
OUTSET = (
    (1.19687900512017, -0.0980208811401368, -0.0990297440797205),
    (-0.0528968517574562, 1.15190312990417, -0.0989611768448433),
    (-0.0529716355144438, -0.0980434501171241, 1.15107367264116),
)
"""Its inverse."""
LOWEST, HIGHEST = -12.47393, 4.026069
"""The exposures, in stops (log2 of radiance), that become black and white."""
CURVE = (-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5)
"""The film curve over the exposures scaled to 0 .. 1, in powers. Its end is scaled to 1: white is white."""
EXPOSURE = 1.6
"""What radiance is multiplied with first."""
CONTRAST = 1.5
SATURATION = 1.3
"""The look that follows the curve; Wrensch's `punchy` has 1.35 and 1.4, no look has 1 and 1."""


def _transform(rows: tuple[tuple[float, float, float], ...], color: Expr) -> Expr:
    graph = color.graph
    return graph.vector(*(graph.dot(graph.constant(*row), color) for row in rows))


def tone_map(graph: FieldGraph) -> Function:
    """AgX: radiance without an upper end into the range of a screen."""
    color = graph.max(graph.input("color"), 0.0)
    inset = graph.max(_transform(INSET, color * EXPOSURE), 1e-10)
    stops = graph.call(Op.LOG, inset) * (1.0 / 0.6931471805599453)
    film = saturate(polynomial(saturate((stops - LOWEST) / (HIGHEST - LOWEST)), CURVE) / sum(CURVE))
    contrast = power(film, CONTRAST)
    look = mix(graph.constant(1.0, 1.0, 1.0) * luminance(contrast), contrast, graph.constant(SATURATION))
    display = saturate(_transform(OUTSET, look))
    return Function("tone_map", (("color", Type.VEC3),), power(display, 2.2), "Linear radiance to linear 0 .. 1 (AgX).")


def encode_srgb(graph: FieldGraph) -> Function:
    """The curve of IEC 61966-2-1."""
    color = saturate(graph.input("color"))
    curved = 1.055 * power(color, 1.0 / 2.4) - 0.055
    straight = 12.92 * color
    encoded = graph.vector(*(graph.select(color[i] <= 0.0031308, straight[i], curved[i]) for i in range(3)))
    return Function("encode_srgb", (("color", Type.VEC3),), encoded, "Linear 0 .. 1 to sRGB 0 .. 1.")
