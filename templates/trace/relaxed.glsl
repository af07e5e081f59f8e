float haste(inout float slope, float measured) {
    slope = measured;
    return {{ parameter.omega }};
}

{% include "lib/overstep.glsl" %}
