#version {{ version }}
{% include "entry/scene.glsl" %}

layout(location = 0) out vec4 first_out;     // depth in scene units (below 0: a miss), steps, material, hit
layout(location = 1) out vec4 normal_out;
layout(location = 2) out vec4 position_out;  // in scene units
layout(location = 3) out vec4 direction_out;

void main() {
    prepare();
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
{% if prepass %}
    look_up_tile();
{% endif %}
    float t = trace(o, d, {{ first_start }}, FAR);
    bool hit = t < FAR;
    vec3 p = o + t * d;
    Surface s = surface(hit ? p : vec3(0.0), d, rounding(hit ? t : 0.0));
{% filter indent(4, true) %}
{% include "shade/polish.glsl" %}
{% endfilter %}
    float sure = 0.25 * unfinished;  // 1 and 0 are hit and miss, 0.75 and 0.25 what was answered at MOST_STEPS
    first_out = hit ? vec4((travelled + t) * RADIUS, steps, s.material, 1.0 - sure) : vec4(-1.0, steps, -1.0, sure);
    normal_out = hit ? vec4(normalize(s.field.xyz), 0.0) : vec4(0.0);
    position_out = hit ? vec4(p * RADIUS + CENTRE, 0.0) : vec4(0.0);
    direction_out = vec4(d, 0.0);
}
