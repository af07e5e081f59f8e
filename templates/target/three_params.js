// What can be changed while it runs: angles in radians, colours linear.
export const params = {
{% for c in controls %}
  {{ c.param }}: { uniform: "{{ c.uniform }}", unit: "{{ c.unit }}", low: {{ c.low | tojson }}, high: {{ c.high | tojson }}, default: {{ (c.default[0] if c.default | length == 1 else c.default | list) | tojson }} },
{% endfor %}
};

export const uniforms = {
{% for c in controls %}
  {{ c.uniform }}: { value: {{ (c.default[0] if c.default | length == 1 else c.default | list) | tojson }} },
{% endfor %}
};
