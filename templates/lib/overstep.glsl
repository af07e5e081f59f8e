// requires: map (generated), tolerance, haste (the tracer's own: how many radii ahead to look, by the slope of the field)
// provides: trace, by looks beyond the ball that proves a step: taken where the two balls meet, else one plain step
// (Keinert 2014, sections 3.1, 3.2 and 3.4, without the defects of the printed listing: tests/trace/printed.py)
{% set smoothing = 3 if parameter.reduce == "2.0" else 0 %}
float trace(vec3 o, vec3 d, float start, float limit) {
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    float t = start, r = 0.0, z = 0.0, slope = -1.0;  // [start, t + r) is proven empty; the next look is at t + z
    float best = FAR, least = {{ parameter.force }} / {{ fine }};  // where the ray came nearest, in tolerances
    int count = 0, state = 0;  // 1 a hit, 2 a miss
{% if smoothing %}
    int left = {{ smoothing }};
{% endif %}
    do {
        float at = t + z, v = map(o + at * d), eps = tolerance(at), gap = z - r - abs(v);
        // A look at the inside shows a root that may not be the first, but for where the balls leave no gap; balls that
        // overlap are of a field that is no bound, and there the middle is as good as any guess.
        bool meets = v >= 0.0 && gap <= rounding(at), flips = v < 0.0 && gap <= eps;
{% if smoothing %}
        bool there = left < {{ smoothing }};
        meets = meets || there;
{% endif %}
        bool nearer = meets && v < r && v < least * eps;
        best = nearer ? at : best;
        least = nearer ? v / eps : least;
        float measured = z > 0.0 ? clamp((v - r) / z, -1.0, 0.99) : -1.0, next = v * haste(slope, measured);
        bool closes = flips && gap >= -eps;
        slope = meets ? slope : -1.0;
        bool found = meets ? v <= eps : closes || r <= eps || flips && z <= eps;
        z = meets ? next : flips ? 0.5 * z : r;
        t = meets ? at : closes ? t + r : t;
{% if parameter.reduce != "0.0" %}
        slope = closes ? measured : slope;
        r = closes ? max(r + r * measured, 0.0) : r;
{% endif %}
        r = meets ? v : r;
{% if smoothing %}
        bool last = left == 0;
        left -= found || there ? 1 : 0;
        z = found || there ? r - eps : z;
        found = (found || there) && last;
{% endif %}
        steps += 1.0;
        evaluations += 1.0;
        count += 1;
        // kept from one pass to the next: llvmpipe forgets what a ray that is done knew but does not keep
        state = found ? 1 : t + r < end ? state : 2;
    } while (state == 0 && count < MOST_STEPS);
    unfinished = state == 0 ? 1.0 : 0.0;
{% if parameter.reduce == "1.0" %}
    float aim = r - tolerance(t);
    t += state == 1 ? clamp(aim / max({{ fine }} * cone.y - slope, 0.05), -4.0 * abs(aim), 4.0 * abs(aim)) : 0.0;
{% endif %}
    return state == 0 ? best : state == 1 && t < end ? t : FAR;
}
