// as far as the next ball touches this one, by a running mean of the slope (Ban and Valasek 2023)
float haste(inout float slope, float measured) {
    slope = mix(slope, measured, {{ parameter.beta }});
    return 2.0 / (1.0 - slope);
}

{% include "lib/overstep.glsl" %}
