#version {{ version }}
{% include "entry/scene.glsl" %}

{% include "shade/radiance.glsl" %}

layout(location = 0) out vec4 color_out;  // sRGB

void main() {
    prepare();
    color_out = vec4(encode_srgb(tone_map(radiance().rgb)), 1.0);
}
