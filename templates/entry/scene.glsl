{% for line in header %}
// {{ line }}
{% endfor %}

{% include camera_template %}

{% for param in params %}
uniform {{ param.type }} {{ param.uniform }};  // {{ param.note }}
{% endfor %}

float steps = 0.0;        // passes of the loops
float evaluations = 0.0;  // values of the whole scene that they took
float unfinished = 0.0;   // 1 where a ray was given up at MOST_STEPS
float travelled = 0.0;  // along the path, to where the ray at hand has t = 0
{% for param in params %}
{{ param.type }} {{ param.name }};
{% endfor %}
{% for value in live %}
{{ value.type }} {{ value.name }};
{% endfor %}

void prepare() {
{% for param in params %}
    {{ param.name }} = {{ param.uniform }};
{% endfor %}
{% for line in live_lines %}
    {{ line }}
{% endfor %}
}

{{ mark }}
const float RADIUS = {{ radius }};  // the scene's own unit ...
const vec3 CENTRE = {{ centre }};  // ... and its own origin

{% include "lib/intervals.glsl" %}

{% include "lib/tolerance.glsl" %}
{% if prepass %}

{% include "lib/prepass.glsl" %}
{% endif %}

{% if needs_marching %}
{% include "lib/marching.glsl" %}

{% endif %}
{% if needs_map_library %}
{% include "lib/distance.glsl" %}

{% endif %}
{% include rebase_template %}
{% if surface %}

{{ surface.structure }}
{% endif %}
{{ mark }}
{{ functions }}
{% if tables %}
{{ tables }}
{% endif %}
{% if map %}
{{ map }}
{% endif %}
{% if map_span %}
{% include "lib/span.glsl" %}

{{ map_span }}
{% endif %}
{{ trace.functions }}
{% if tracer_template %}
{% include tracer_template %}
{% endif %}

{% if surface %}
{{ surface.function }}
{% endif %}
