{% include "target/part/field.glsl" %}

float steps = 0.0;        // passes of the loops
float evaluations = 0.0;  // values of the whole scene that they took
float unfinished = 0.0;   // 1 where a ray was given up
float travelled = 0.0;    // along the path, to where the ray at hand has t = 0
vec2 cone = vec2(0.0);    // half a pixel: size at the eye, growth with the distance

{% include "lib/tolerance.glsl" %}

{% if needs_marching %}
{% include "lib/marching.glsl" %}

{% endif %}
{% include "lib/rebase.glsl" %}

{% if map_span %}
{% include "lib/span.glsl" %}

{{ map_span }}
{% endif %}
{{ trace.functions }}
{% include tracer_template %}

{{ surface.structure }}
{{ surface.function }}

// What a ray meets first. Without it, only `found` means anything.
struct Found {
    bool found;
    float t;        // how far from the ray's origin, in the scene's units
    vec3 position;
    vec3 normal;    // of unit length, outward
    int material;
    Properties looks;
};

// The first surface along a ray from `origin` along `direction` (of any length), at a distance of tmin to tmax.
// `pixel`: half a pixel's size at the origin, and its growth with the distance; none asks for all that float32 has.
Found trace_pixel(vec3 origin, vec3 direction, float tmin, float tmax, vec2 pixel) {
    vec3 o = (origin - CENTRE) / RADIUS, d = normalize(direction);
    cone = vec2(pixel.x / RADIUS, pixel.y);
    steps = 0.0;
    travelled = rebase(o, d);
    float t = trace(o, d, tmin / RADIUS - travelled, min(tmax / RADIUS - travelled, FAR));
    bool hit = t < FAR && travelled + t <= tmax / RADIUS;
    vec3 p = o + t * d;
    Surface s = surface(hit ? p : vec3(0.0), d, rounding(hit ? t : 0.0));
{% filter indent(4, true) %}
{% include "shade/polish.glsl" %}
{% endfilter %}
    return Found(hit, (travelled + t) * RADIUS, RADIUS * p + CENTRE, normalize(s.field.xyz), int(s.material + 0.5), Properties({{ surface_values }}));
}

Found trace_ray(vec3 origin, vec3 direction, float tmin, float tmax) {
    return trace_pixel(origin, direction, tmin, tmax, vec2(0.0));
}
