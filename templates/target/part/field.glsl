{% for param in params %}
uniform {{ param.type }} {{ param.name }};  // {{ param.note }}
{% endfor %}
const float RADIUS = {{ radius }};  // the scene's own unit, and its own origin
const vec3 CENTRE = {{ centre }};
const float FAR = {{ far }};
{% if needs_map_library %}
{% include "lib/distance.glsl" %}
{% endif %}

{{ functions }}
{{ tables }}
{{ map }}
{{ nearest.structure }}
{{ nearest.function }}
// At most the distance from p to the surface; below 0 inside.
float sdf(vec3 p) { return RADIUS * map((p - CENTRE) / RADIUS); }

// Its gradient, of the part that is nearest: the normal, on the surface.
vec3 gradient(vec3 p) { return nearest((p - CENTRE) / RADIUS).field.xyz; }

// Which material is nearest.
int material(vec3 p) { return int(nearest((p - CENTRE) / RADIUS).material + 0.5); }

// What it looks like; colours are linear.
struct Properties {
    vec3 color;
    float metallic;
    float roughness;
    vec3 emission;
    float transmission;
    float ior;
    vec3 tint;
};

Properties properties(vec3 p) {
    Nearest s = nearest((p - CENTRE) / RADIUS);
    return Properties({{ nearest_values }});
}
