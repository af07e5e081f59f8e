// requires: map, map_span (generated), tolerance
// provides: trace, by the slope of the field over the piece of the ray ahead (Galin et al. 2020; one-sided, Aydinlilar and
// Zanni 2023): [t, t + v / fall] is empty where the field falls no faster, and no step is shorter than sphere tracing's
float trace(vec3 o, vec3 d, float start, float limit) {
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    float t = start, s = end - start;
    int count = 0, state = 0;  // 1 a hit, 2 a miss
    do {
        vec3 p = o + t * d;
        float v = map(p), eps = tolerance(t), reach = clamp(s, eps, max(end - t, eps));
        vec4 piece = map_span(p, d, reach);
{% if parameter.symmetric == "1.0" %}
        float fall = max(-piece.z, piece.w);
        bool is_clear = v > 0.0 && fall * reach < v;
{% else %}
        float fall = -piece.z;
        bool is_clear = piece.x > 0.0 || v > 0.0 && fall * reach < v;
{% endif %}
        bool found = v <= eps && !is_clear;
        float root = max(found ? v : v - 0.5 * eps, 0.0) / max(fall, 1e-6);
        float clear = max(is_clear ? reach : root, found ? 0.0 : v) * 0.9999996;
        s = {{ parameter.growth }} * clear;
        t += clear;
        steps += 1.0;
        evaluations += 2.0;  // the value, and what bounds it
        count += 1;
        // kept from one pass to the next: llvmpipe forgets what a ray that is done knew but does not keep
        state = found ? 1 : t < end ? state : 2;
    } while (state == 0 && count < MOST_STEPS);
    unfinished = state == 0 ? 1.0 : 0.0;
    return state == 1 && t < end ? t : FAR;
}
