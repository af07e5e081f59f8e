// requires: events or march (generated)
// provides: trace, the first hit at or after `start` and before `limit`, or FAR
float trace(vec3 o, vec3 d, float start, float limit) {
{% if trace.events %}
    float first = events(o, d, start);
{% else %}
    float first = FAR;
{% endif %}
{% if trace.march %}
{% if not finite %}
    // the scene has no end: nothing is marched to beyond its horizon
{% endif %}
    first = min(first, march(o, d, {{ "max(start, cleared)" if prepass else "start" }}, min(first, {{ 'limit' if finite else 'min(limit, ' ~ horizon ~ ')' }})));
{% endif %}
    return first < limit ? first : FAR;
}
