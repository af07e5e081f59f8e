{% if version %}
#version {{ version }}
{% endif %}
{% include "entry/scene.glsl" %}

{% include "shade/radiance.glsl" %}

layout(location = 0) out vec4 color_out;  // sRGB

void main() {
    prepare();
    vec3 o, d;
    camera_ray(o, d);
    vec4 seen = radiance();
    if (seen.a < 0.5 || travelled > gone) discard;
    vec4 place = vec4(RADIUS * (o + travelled * d) + CENTRE, 1.0);
    gl_FragDepth = 0.5 * dot(depth_row, place) / dot(weight_row, place) + 0.5;
    color_out = vec4(encode_srgb(tone_map(seen.rgb)), 1.0);
}
