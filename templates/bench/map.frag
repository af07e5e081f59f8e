#version {{ version }}
// Somebody's own `float map(vec3 p)`, in the scene's units, marched by the tracer `sphere`.
#define map foreign_map
#line 1
{{ text }}
#line 100001
#undef map
{% for name in taken %}
#undef {{ name }}
#define {{ name }} sdfc_{{ name }}
{% endfor %}
#ifndef STEP_FACTOR
#define STEP_FACTOR 1.0
#endif
#ifndef MAX_STEPS
#define MAX_STEPS {{ most_steps }}
#endif

{% include "lib/camera_varying.glsl" %}

const float RADIUS = {{ radius }};
const vec3 CENTRE = {{ centre }};
const float FAR = {{ far }};
const int MOST_STEPS = MAX_STEPS;
layout(location = 0) out vec4 first_out;

float steps = 0.0, evaluations = 0.0, unfinished = 0.0, travelled = 0.0;

float map(vec3 p) { return STEP_FACTOR * foreign_map(p * RADIUS + CENTRE) / RADIUS; }

// A step factor shortens steps, not what is near enough: both sides of the tracer's comparison carry it.
#ifdef EPSILON
float tolerance(float t) { return STEP_FACTOR * EPSILON / RADIUS; }
#else
float own_tolerance(float t) {
    return max({{ smallest }} * max(1.0, abs(t)), {{ fine }} * (cone.x + cone.y * (travelled + t)));
}
float tolerance(float t) { return STEP_FACTOR * own_tolerance(t); }
#endif

{% include "lib/rebase.glsl" %}

{% include "trace/sphere.glsl" %}

void main() {
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
#ifdef FAR_PLANE
    float t = trace(o, d, -travelled, FAR_PLANE / RADIUS - travelled);
#else
    float t = trace(o, d, -travelled, FAR);
#endif
    bool hit = t < FAR;
    float sure = 0.25 * unfinished;
    first_out = hit ? vec4((travelled + t) * RADIUS, steps, evaluations, 1.0 - sure) : vec4(-1.0, steps, evaluations, sure);
}
