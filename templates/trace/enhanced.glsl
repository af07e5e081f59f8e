// as far as the next ball touches this one, were the field as steep all along (Balint and Valasek 2018)
float haste(inout float slope, float measured) {
    slope = measured;
    return 1.0 + {{ parameter.omega }} * (1.0 + slope) / (1.0 - slope);
}

{% include "lib/overstep.glsl" %}
