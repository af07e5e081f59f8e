float haste(inout float slope, float measured) { return {{ parameter.omega }}; }

{% include "lib/overstep.glsl" %}
