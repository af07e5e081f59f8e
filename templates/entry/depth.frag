#version {{ version }}
{% include "entry/scene.glsl" %}

layout(location = 0) out vec4 first_out;  // depth in scene units (below 0: a miss), steps, no material, hit

void main() {
    prepare();
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
    float t = trace(o, d, -travelled, FAR);
    first_out = t < FAR ? vec4((travelled + t) * RADIUS, steps, -1.0, 1.0) : vec4(-1.0, steps, -1.0, 0.0);
}
