#version {{ version }}
{% include "entry/scene.glsl" %}

layout(location = 0) out vec4 first_out;  // depth in scene units (below 0: a miss), steps, evaluations, hit

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
    float sure = 0.25 * unfinished;  // 1 and 0 are hit and miss, 0.75 and 0.25 what was answered at MOST_STEPS
    first_out = hit ? vec4((travelled + t) * RADIUS, steps, evaluations, 1.0 - sure) : vec4(-1.0, steps, evaluations, sure);
}
