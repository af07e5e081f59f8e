"""Every shading function by name, so that a shader gets those that its scene needs and no other."""

from collections.abc import Callable

from sdfc.field.function import Function
from sdfc.field.graph import FieldGraph
from sdfc.shade.ambient import ambient, occlusion_weight
from sdfc.shade.glass import transmit
from sdfc.shade.sky import sky_radiance, sun_disc
from sdfc.shade.surface import point_falloff, reflect_light
from sdfc.shade.tone import encode_srgb, tone_map

FUNCTIONS: dict[str, Callable[[FieldGraph], Function]] = {
    builder.__name__: builder
    for builder in (
        sky_radiance,
        sun_disc,
        reflect_light,
        point_falloff,
        occlusion_weight,
        ambient,
        transmit,
        tone_map,
        encode_srgb,
    )
}
"""The builders. Each function stands alone: none calls another."""
