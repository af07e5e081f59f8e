"""Light that a surface sends on: the metallic-roughness model over GGX, conserving energy and reciprocal.

GGX with the height-correlated Smith term (Walter 2007, Heitz 2014) and Fresnel by Schlick (1994). The diffuse part gets
what the specular part leaves, by Kelemen and Szirmay-Kalos (2001). Light that bounces between the facets of a rough
surface is given back, after Kulla and Conty (2017). The integrals that these need are polynomials fitted to this model.
"""

import math
from dataclasses import dataclass

from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.shade.vector import fifth_power, mix, normalize, polynomial, power, saturate, square

ROUGHNESS_FLOOR = 0.09
"""Smoother is drawn as this: the lights have no size, and a mirror would show them too small for any pixel."""
DIELECTRIC = 0.04
"""The reflectance at normal incidence of what is not metal (an index of 1.5)."""
GRAZING = 1e-4
"""The least cosine with the view: a normal of a visible surface turns away from the viewer only by rounding."""

_LOST = (
    (6.033, -28.663, 38.325, -15.85),
    (-22.976, 130.466, -190.177, 82.835),
    (29.036, -176.513, 273.082, -122.696),
    (-12.016, 76.425, -123.158, 56.543),
)
"""1 - E(c, r), what GGX of one bounce loses, is the sum of row i, column j times r^(i + 2) c^j."""
_LOST_MEAN = (0.232, -1.7301, 8.9283, -11.227, 4.3982)
"""Its mean over directions, 2 times the integral of (1 - E) c dc: the sum of entry i times r^(i + 2)."""
_DIELECTRIC_MEAN = (0.0848, -0.002, -0.1774, 0.1146)
"""The mean reflectance of a dielectric, in powers of roughness."""

SURFACE = (("color", Type.VEC3), ("metallic", Type.FLOAT), ("roughness", Type.FLOAT))
"""The parameters, common to several functions, that say what the surface is."""


@dataclass(frozen=True, slots=True)
class Surface:
    """Expressions of a surface's look, made safe: roughness not under the floor, everything in 0 .. 1."""

    diffuse: Expr  # VEC3: what of the diffuse light is not absorbed
    normal_reflectance: Expr  # VEC3: F0
    roughness: Expr

    @property
    def names(self) -> dict[Expr, str]:
        """What these are called in print."""
        return {self.diffuse: "unabsorbed", self.normal_reflectance: "head_on", self.roughness: "rough"}


def surface(graph: FieldGraph) -> Surface:
    """The surface that the INPUT nodes of `SURFACE` describe."""
    color = saturate(graph.input("color"))
    metallic = saturate(graph.input("metallic", Type.FLOAT))
    roughness = graph.clamp(graph.input("roughness", Type.FLOAT), ROUGHNESS_FLOOR, 1.0)
    normal_reflectance = mix(graph.constant(*[DIELECTRIC] * 3), color, metallic)
    return Surface(color * (1.0 - metallic), normal_reflectance, roughness)


def lost(cosine: Expr, roughness: Expr) -> Expr:
    """The energy that one bounce on GGX loses along `cosine`, were the facets perfect mirrors."""
    result = polynomial(cosine, _LOST[-1])
    for row in reversed(_LOST[:-1]):
        result = result * roughness + polynomial(cosine, row)
    return saturate(square(roughness) * result)


def lost_mean(roughness: Expr) -> Expr:
    """The mean of `lost` over all directions, never 0."""
    return square(roughness) * polynomial(roughness, _LOST_MEAN)


def fresnel_share(cosine: Expr, roughness: Expr) -> Expr:
    """B of E = F0 A + B: the reflectance along `cosine` that is there even for F0 = 0."""
    exponent = 2.6 + 2.4 / (1.0 + 125.0 * roughness * square(roughness))
    return power(saturate(1.0 - cosine), exponent) / (1.0 + square(roughness) * (7.0 + 15.0 * roughness))


def dielectric_albedo(cosine: Expr, roughness: Expr) -> Expr:
    """The reflectance along `cosine` of a surface that is not metal, which its diffuse part does without."""
    return DIELECTRIC * (1.0 - lost(cosine, roughness)) + (1.0 - DIELECTRIC) * fresnel_share(cosine, roughness)


def between_facets(look: Surface) -> Expr:
    """The colour (VEC3) of light after two or more bounces between facets (Kulla and Conty 2017)."""
    gone = lost_mean(look.roughness)
    fresnel_mean = look.normal_reflectance * (20.0 / 21.0) + 1.0 / 21.0
    return square(fresnel_mean) * (1.0 - gone) / (1.0 - fresnel_mean * gone)


def _microfacets(half: Expr, normal: Expr, n_l: Expr, n_v: Expr, alpha: Expr, names: dict[Expr, str]) -> Expr:
    """D V: the distribution times the visibility (which has the denominator 4 (n·l) (n·v) in it)."""
    graph = normal.graph
    across = graph.cross(normal, half)
    # sin² by the cross product: 1 - (n·h)² has no digits left in 32 bits where a smooth surface has its highlight
    scaled = saturate(graph.dot(normal, half)) * alpha
    spread = alpha / (graph.dot(across, across) + square(scaled) + 1e-12)
    alpha_2 = square(alpha)
    smith_light = n_v * graph.sqrt(square(n_l) * (1.0 - alpha_2) + alpha_2)
    smith_view = n_l * graph.sqrt(square(n_v) * (1.0 - alpha_2) + alpha_2)
    names |= {across: "across", alpha: "alpha", spread: "spread", smith_light: "smith_light", smith_view: "smith_view"}
    return square(spread) * (0.5 / math.pi) / (smith_light + smith_view)


def reflect_light(graph: FieldGraph) -> Function:
    """BRDF times the cosine with the light: multiply by the light's irradiance and by what the shadows leave."""
    normal, view, light = graph.input("normal"), graph.input("view"), graph.input("light")
    look = surface(graph)
    n_l = saturate(graph.dot(normal, light))
    n_v = graph.clamp(graph.dot(normal, view), GRAZING, 1.0)
    half = normalize(view + light)
    names = {n_l: "n_dot_l", n_v: "n_dot_v", half: "halfway", **look.names}
    fresnel = fifth_power(saturate(1.0 - graph.dot(view, half)))
    facets = mix(look.normal_reflectance, graph.constant(1.0, 1.0, 1.0), fresnel)
    once = facets * _microfacets(half, normal, n_l, n_v, square(look.roughness), names)
    lost_light, lost_view, mean = lost(n_l, look.roughness), lost(n_v, look.roughness), lost_mean(look.roughness)
    again = between_facets(look) * (lost_light * lost_view / (math.pi * mean))
    albedo_light, albedo_view = dielectric_albedo(n_l, look.roughness), dielectric_albedo(n_v, look.roughness)
    left = (1.0 - albedo_light) * (1.0 - albedo_view)
    diffuse = look.diffuse * (left / (math.pi * (1.0 - polynomial(look.roughness, _DIELECTRIC_MEAN))))
    names |= {fresnel: "fresnel", facets: "facets", once: "one_bounce", again: "more_bounces", diffuse: "diffuse"}
    names |= {lost_light: "lost_light", lost_view: "lost_view", mean: "lost_mean"}
    names |= {albedo_light: "albedo_light", albedo_view: "albedo_view"}
    return Function(
        "reflect_light",
        (("normal", Type.VEC3), ("view", Type.VEC3), ("light", Type.VEC3), *SURFACE),
        (diffuse + once + again) * n_l,
        "BRDF times n·l (VEC3). Unit vectors: normal, view (to the eye), light (to the light).",
        names,
    )


def point_falloff(graph: FieldGraph) -> Function:
    """What the distance leaves of a point light's intensity."""
    offset = graph.input("offset")
    return Function(
        "point_falloff",
        (("offset", Type.VEC3),),
        1.0 / graph.max(graph.dot(offset, offset), 1e-8),
        "1 / distance² for the vector from the surface to a point light, in scene units.",
    )
