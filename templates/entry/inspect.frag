#version {{ version }}
{% include "entry/scene.glsl" %}

uniform int shown;  // 1 depth, 2 normals, 3 steps, 4 materials

layout(location = 0) out vec4 color_out;  // sRGB, scaled for the eye

const vec3 BEYOND = vec3(0.11, 0.118, 0.13);  // where nothing is hit
const float MANY_STEPS = 127.0;               // the end of the scale of steps

// Dark to pale by five colours of `inferno` (Smith and van der Walt 2015), straight lines between them.
vec3 heat(float share) {
    float at = 4.0 * clamp(share, 0.0, 1.0);
    vec3 color = mix(vec3(0.0, 0.0, 4.0), vec3(87.0, 16.0, 110.0), min(at, 1.0));
    color = mix(color, vec3(188.0, 55.0, 84.0), clamp(at - 1.0, 0.0, 1.0));
    color = mix(color, vec3(249.0, 142.0, 9.0), clamp(at - 2.0, 0.0, 1.0));
    return mix(color, vec3(252.0, 255.0, 164.0), clamp(at - 3.0, 0.0, 1.0)) / 255.0;
}

// A colour for each number: hues that are the golden section apart.
vec3 distinct(float number) {
    return 0.6 + 0.3 * cos(6.2831853 * (fract(0.618034 * number) + vec3(0.0, 0.6666667, 0.3333333)));
}

void main() {
    prepare();
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
    float t = trace(o, d, {{ first_start }}, FAR);
    bool hit = t < FAR;
    vec3 p = o + t * d;
    Surface s = surface(hit ? p : vec3(0.0), d, rounding(hit ? t : 0.0));
{% filter indent(4, true) %}
{% include "shade/polish.glsl" %}
{% endfilter %}
    // white where the ball around the scene begins, or at the eye in it; a radius behind that, 1.2 halvings
    float nearness = exp2(-1.2 * max(travelled + t - max(length(eye) - 1.0, 0.0), 0.0));
    vec3 color = shown == 1 ? mix(BEYOND, vec3(1.0), nearness)
        : shown == 2 ? 0.5 + 0.5 * normalize(s.field.xyz)
        : distinct(floor(s.material + 0.5));
    color = hit ? color : BEYOND;
    color_out = vec4(shown == 3 ? heat(log2(1.0 + steps) / log2(1.0 + MANY_STEPS)) : color, 1.0);
}
