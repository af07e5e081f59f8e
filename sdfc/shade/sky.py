"""The sky: a smooth gradient from the ground below over the horizon to the zenith, and what of it a surface receives.

The sky depends only on the height h = direction · up, so that it is made of weights in h for each of its three
colours. A glossy surface sees it blurred, a matt one its mean under a cosine: both are forms of the same weights.
"""

from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Operand, Type
from sdfc.shade.vector import mix, polynomial, saturate

CURVE = 0.17
"""How fast the horizon's colour gives way to the zenith's: half way up in colour at h = CURVE / (1 + 2 CURVE)."""
HORIZON_DEPTH = 0.34
"""The height below the horizon where the ground's colour has half come."""
HORIZON_WIDTH = 0.15
"""The scale of the passage from horizon to ground."""
SEAM = 0.01
"""How softly the upper gradient starts at the horizon, in h: no line is seen there."""

ZENITH_UNDER_COSINE = (0.3687, 0.4485, 0.0461, 0.0, 0.0315)
"""The zenith's share of the mean sky under a cosine lobe whose axis has height c: a polynomial in c."""
GROUND_UNDER_COSINE = (0.2954, -0.4207, 0.0794, 0.0, 0.0512)
"""The same for the ground's share. Both are least-squares fits of this module's weights; a test integrates them."""

SKY_COLORS = (("zenith", Type.VEC3), ("horizon", Type.VEC3), ("ground", Type.VEC3))
"""The parameters, common to several functions, that say what sky there is (linear radiance)."""


def gradient(height: Expr, colors: tuple[Expr, Expr, Expr], blur: Operand = 0.0) -> Expr:
    """The radiance (VEC3) at `height` = direction · up in -1 .. 1, as seen through a lobe of width `blur` in 0 .. 1."""
    graph = height.graph
    zenith, horizon, ground = colors
    wide = graph.lift(blur)
    seen = height * (1.0 - 0.35 * wide)
    softness = SEAM + 0.4 * wide
    above = graph.min(0.5 * (seen + graph.sqrt(seen * seen + softness * softness)), 1.0)
    to_zenith = above * (1.0 + CURVE) / (above + CURVE)
    depth = (seen + HORIZON_DEPTH * (1.0 - wide)) / (HORIZON_WIDTH + 0.35 * wide)
    to_ground = 0.5 - 0.5 * depth / graph.sqrt(1.0 + depth * depth)
    return mix(mix(horizon, zenith, to_zenith), ground, to_ground)


def mean_under_cosine(height: Expr, colors: tuple[Expr, Expr, Expr]) -> Expr:
    """Irradiance / pi (VEC3) of a plane whose normal has `height` = normal · up."""
    zenith, horizon, ground = colors
    to_zenith = polynomial(height, ZENITH_UNDER_COSINE)
    to_ground = polynomial(height, GROUND_UNDER_COSINE)
    return zenith * to_zenith + ground * to_ground + horizon * (1.0 - to_zenith - to_ground)


def height_of(direction: Expr, up: Expr) -> Expr:
    """The sine of the elevation of a unit direction, kept in -1 .. 1."""
    return direction.graph.clamp(direction.graph.dot(direction, up), -1.0, 1.0)


def sky_colors(graph: FieldGraph) -> tuple[Expr, Expr, Expr]:
    """The INPUT nodes of `SKY_COLORS`."""
    return graph.input("zenith"), graph.input("horizon"), graph.input("ground")


def sky_radiance(graph: FieldGraph) -> Function:
    """What a ray that leaves the scene sees."""
    height = height_of(graph.input("direction"), graph.input("up"))
    return Function(
        "sky_radiance",
        (("direction", Type.VEC3), ("up", Type.VEC3), *SKY_COLORS),
        gradient(height, sky_colors(graph)),
        "Radiance (VEC3) of the sky along a unit direction.",
    )


def sun_disc(graph: FieldGraph) -> Function:
    """How much of the sun is seen along a ray: 1 on its disc, a faint glow around it."""
    cosine = graph.clamp(graph.dot(graph.input("direction"), graph.input("toward")), -1.0, 1.0)
    # 1 - cos is the square of the angle over 2; the disc is drawn 1 degree in radius, twice the true sun
    away = (1.0 - cosine) / 1.5e-4
    disc = saturate(2.5 - 2.0 * away)
    glow = 0.012 / (1.0 + 0.02 * away)
    return Function(
        "sun_disc",
        (("direction", Type.VEC3), ("toward", Type.VEC3)),
        graph.min(disc + glow, 1.0),
        "The sun's share (0 to 1) along a unit direction; `toward` is the unit direction of the sun.",
    )
