#version {{ version }}
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba8, binding = 0) uniform writeonly image2D picture;  // sRGB

{% include "entry/scene.glsl" %}

{% include "shade/radiance.glsl" %}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, ivec2(window.xy)))) return;
    prepare();
    imageStore(picture, at, vec4(encode_srgb(tone_map(radiance().rgb)), 1.0));
}
