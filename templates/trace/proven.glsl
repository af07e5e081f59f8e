// requires: events or march (generated)
// provides: trace
float trace(vec3 o, vec3 d, float start, float limit) {
    float first = limit;
{% if trace.events %}
    float event = events(o, d, start);
    first = event < limit ? event : FAR;
{% endif %}
{% if trace.march %}
    first = min(first, march(o, d, start, min(first, limit)));
{% endif %}
    return first < limit ? first : FAR;
}
