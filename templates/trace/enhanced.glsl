// as far as the next ball touches this one, were the field as steep all along (Balint and Valasek 2018)
float haste(inout float slope, float measured) { return 1.0 + {{ parameter.omega }} * (1.0 + measured) / (1.0 - measured); }

{% include "lib/overstep.glsl" %}
