#version {{ version }}
{% include "entry/scene.glsl" %}

{% include "shade/radiance.glsl" %}

layout(location = 0) out vec4 radiance_out;  // linear radiance, and whether something was hit

void main() {
    prepare();
    radiance_out = radiance();
}
