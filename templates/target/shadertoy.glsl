{% include "entry/scene.glsl" %}

{% include "shade/radiance.glsl" %}

void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    pixel_centre = fragCoord;
    prepare();
    fragColor = vec4(encode_srgb(tone_map(radiance().rgb)), 1.0);
}
