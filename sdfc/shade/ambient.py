"""Light from all around: the sky on a surface, dimmed where the surroundings hide it."""

from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.shade.sky import SKY_COLORS, gradient, height_of, mean_under_cosine, sky_colors
from sdfc.shade.surface import (
    GRAZING,
    SURFACE,
    Surface,
    between_facets,
    dielectric_albedo,
    fresnel_share,
    lost,
    surface,
)
from sdfc.shade.vector import exponential, power, reflect, saturate, square

OCCLUSION_HEIGHTS = (0.012, 0.045, 0.11, 0.22)
"""Where `occlusion_weight` wants its taps: heights over the surface, as parts of the scene's radius."""
OCCLUSION_WEIGHTS = (0.1, 0.3, 0.33, 0.27)
"""What each tap counts for; the sum is 1."""
DARKEST = 0.12
"""What is left of the sky where every tap is blocked: a little light finds its way in everywhere."""


def several_bounces(occlusion: Expr, albedo: Expr) -> Expr:
    """Occlusion (VEC3) brightened by light that the bright walls of a hollow pass on (Jimenez et al. 2016)."""
    graph = occlusion.graph
    a = 2.0404 * albedo - 0.3324
    b = -4.7951 * albedo + 0.6417
    c = 2.7552 * albedo + 0.6903
    return graph.max(graph.constant(1.0, 1.0, 1.0) * occlusion, ((a * occlusion + b) * occlusion + c) * occlusion)


def specular_occlusion(n_v: Expr, occlusion: Expr, roughness: Expr) -> Expr:
    """How much of the sky's mirror image is not hidden (Lagarde and de Rousiers 2014)."""
    sharpness = exponential(-11.09 * roughness - 0.693)  # 2^(-16 r - 1)
    return saturate(power(n_v + occlusion, sharpness) - 1.0 + occlusion)


def sky_reflected(look: Surface, n_v: Expr) -> Expr:
    """The reflectance (VEC3) of the whole lobe: F0 A + B and what bounces between the facets."""
    gone = lost(n_v, look.roughness)
    bias = fresnel_share(n_v, look.roughness)
    kept = look.normal_reflectance * look.normal_reflectance.graph.max(1.0 - gone - bias, 0.0) + bias
    return kept + between_facets(look) * gone


def ambient(graph: FieldGraph) -> Function:
    """The sky's light that a surface sends to the eye, diffuse and mirrored."""
    normal, view, up = graph.input("normal"), graph.input("view"), graph.input("up")
    occlusion = saturate(graph.input("occlusion", Type.FLOAT))
    colors = sky_colors(graph)
    look = surface(graph)
    n_v = graph.clamp(graph.dot(normal, view), GRAZING, 1.0)
    albedo, sky = dielectric_albedo(n_v, look.roughness), mean_under_cosine(height_of(normal, up), colors)
    bounces = several_bounces(occlusion, look.diffuse)
    diffuse = look.diffuse * (1.0 - albedo) * sky * bounces
    mirrored = gradient(height_of(reflect(view, normal), up), colors, square(look.roughness))
    reflectance, unhidden = sky_reflected(look, n_v), specular_occlusion(n_v, occlusion, look.roughness)
    specular = reflectance * mirrored * unhidden
    names = {n_v: "n_dot_v", albedo: "albedo", sky: "sky_around", bounces: "bounced", mirrored: "sky_mirrored"}
    names |= {reflectance: "reflectance", unhidden: "unhidden", diffuse: "diffuse", specular: "specular", **look.names}
    return Function(
        "ambient",
        (
            ("normal", Type.VEC3),
            ("view", Type.VEC3),
            ("up", Type.VEC3),
            *SURFACE,
            ("occlusion", Type.FLOAT),
            *SKY_COLORS,
        ),
        diffuse + specular,
        "Radiance (VEC3) from the sky; `occlusion` is 1 in the open and 0 where no sky is seen.",
        names,
    )


def occlusion_weight(graph: FieldGraph) -> Function:
    """The open part of the sky from the distances at four heights along the normal (after Evans 2006 and Quilez 2008).

    A field that is only a lower bound rises more slowly than the height does. Its slope is read off the lowest tap, so
    that a plane in such a field is not taken for a hollow; the slope believed is at least 1/4, so that a crease is.
    """
    distances = graph.input("distances", Type.VEC4)
    heights = graph.max(graph.input("heights", Type.VEC4), 1e-12)
    open_part = distances / heights
    slope = graph.clamp(open_part[0], 0.25, 1.0)
    blocked = 1.0 - saturate(open_part / slope)
    weight = graph.dot(blocked, graph.constant(*OCCLUSION_WEIGHTS))
    return Function(
        "occlusion_weight",
        (("distances", Type.VEC4), ("heights", Type.VEC4)),
        saturate(1.0 - (1.0 - DARKEST) * weight),
        "Ambient occlusion (1 is open) from distances at heights over the surface, lowest first, same unit.",
    )
