"""Glass: the sky in it and through it, with no ray traced on.

The ray is bent as a solid ball would bend it, which turns the sky over as glass does; what leaves is
never darker than the tint says.
"""

from sdfc.field.function import Function
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.shade.sky import SKY_COLORS, gradient, height_of, sky_colors
from sdfc.shade.surface import GRAZING
from sdfc.shade.vector import mix, power, reflect, saturate, square


def dielectric_fresnel(cosine: Expr, inside: Expr, ior: Expr) -> Expr:
    """Reflectance of a clear surface (Fresnel, unpolarised); `inside` is the cosine of the bent ray."""
    upright = (cosine - ior * inside) / (cosine + ior * inside)
    flat = (ior * cosine - inside) / (ior * cosine + inside)
    return saturate(0.5 * (square(upright) + square(flat)))


def transmit(graph: FieldGraph) -> Function:
    """What a clear solid shows: a reflection of the sky, and the sky behind, bent and tinted."""
    normal, view, up = graph.input("normal"), graph.input("view"), graph.input("up")
    ior = graph.clamp(graph.input("ior", Type.FLOAT), 1.0, 4.0)
    tint = saturate(graph.input("tint"))
    colors = sky_colors(graph)
    n_v = graph.clamp(graph.dot(normal, view), GRAZING, 1.0)
    inside = graph.sqrt(graph.max(1.0 - (1.0 - square(n_v)) / square(ior), 1e-6))
    bent = view / (-ior) + normal * (n_v / ior - inside)
    # in a ball the ray turns by the same angle when it leaves: the way out is the way in, mirrored at the way through
    out = bent * (-2.0 * graph.dot(bent, view)) + view
    reflected = gradient(height_of(reflect(view, normal), up), colors)
    # the middle of a ball is thicker than its rim
    seen = gradient(height_of(out, up), colors) * power(tint, inside)
    return Function(
        "transmit",
        (
            ("normal", Type.VEC3),
            ("view", Type.VEC3),
            ("up", Type.VEC3),
            ("ior", Type.FLOAT),
            ("tint", Type.VEC3),
            *SKY_COLORS,
        ),
        mix(seen, reflected, dielectric_fresnel(n_v, inside, ior)),
        "Radiance (VEC3) of clear glass under the sky; mix it with what the opaque surface gives, by transmission.",
    )
