{% for line in header %}
// {{ line }}
{% endfor %}

{% include "target/three_params.js" %}

// To be put into a shader of yours (GLSL3, or an onBeforeCompile), in front of what calls it.
export const glsl = /* glsl */ `
{{ text | in_template_literal }}`;
