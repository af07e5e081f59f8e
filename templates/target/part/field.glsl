{% for param in params %}
uniform {{ param.type }} {{ param.name }};  // {{ param.note }}
{% endfor %}
{% if not is_whole %}
const float RADIUS = {{ radius }};  // the scene's own unit, and its own origin
const vec3 CENTRE = {{ centre }};
{% endif %}
{% if part == "field" %}
const float FAR = {{ far }};
{% else %}
{% include "lib/intervals.glsl" %}

{% endif %}
{% if needs_map_library %}
{% include "lib/distance.glsl" %}
{% endif %}

{{ functions }}
{{ tables }}
// At most the distance from p to the surface; below 0 inside.
{{ map | replace("float map(", "float sdf(") if is_whole else map }}
{{ nearest.structure }}
{{ nearest.function }}
{% if not is_whole %}
float sdf(vec3 p) { return RADIUS * map({{ own_p }}); }

{% endif %}
// Its gradient, of the nearest part: along the normal near the surface.
vec3 gradient(vec3 p) { return nearest({{ own_p }}).field.xyz; }

// Which material is nearest.
int material(vec3 p) { return int(nearest({{ own_p }}).material + 0.5); }

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
{% if not is_whole %}
    p = {{ own_p }};
{% endif %}
{{ nearest.properties }}
}
