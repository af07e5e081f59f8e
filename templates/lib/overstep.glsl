{% include "lib/refine.glsl" %}

// requires: map (generated), tolerance, haste (the tracer's own: how many radii ahead to look, by the slope of the field)
// provides: trace, by looks beyond the ball that proves a step: taken where the two balls meet, else one plain step
// (Keinert 2014, sections 3.1 and 3.2, without the defects of the printed listing)
float trace(vec3 o, vec3 d, float start, float limit) {
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    float t = start, r = 0.0;        // [start, t + r) is proven empty
    float z = 0.0, slope = -1.0;     // the next look is at t + z
    float ahead = FAR, value = 1.0;  // a look beyond what is proven, and its value
    float best = FAR, least = {{ parameter.force }} / {{ fine }};  // where the ray came nearest, in tolerances
    bool broken = false, found;      // broken: balls of both signs overlap, so that the field is no bound of the distance
    Bracket b = bracket(0.0, 1.0, 0.0, 0.0);
    int count = 0;
    do {
        float at = t + z, v = map(o + at * d), eps = tolerance(at);
        if (broken) {
            narrow(b, at, v);
        } else if (v >= 0.0 && z <= r + v + rounding(at)) {
            float before = r, step = z;
            t = at;
            r = v;
            if (value > 0.0 && t + r + value >= ahead) {  // what was seen ahead is proven now
                before = r;
                step = ahead - t;
                t = ahead;
                r = value;
                ahead = FAR;
            }
            if (r < before && r < least * eps) {
                least = r / eps;
                best = t;
            }
            z = r * haste(slope, step > 0.0 ? clamp((r - before) / step, -1.0, 0.99) : -1.0);
        } else {
            ahead = at;
            value = v;
            slope = -1.0;
            z = r;
        }
        float gap = ahead - abs(value) - t - r;
        found = r <= eps || value <= 0.0 && gap <= eps;
        z = min(z, r + 0.5 * max(gap, 0.0));
        if (gap < -eps && value <= 0.0 && ahead > t) {
            b = broken ? b : bracket(t, r, ahead, value);
            broken = true;
            found = abs(v) <= eps || b.inner - b.outer <= eps;
            z = look(b) - t;
        }
        steps += 1.0;
        evaluations += 1.0;
        count += 1;
    } while (!found && t + r < end && count < MOST_STEPS);
    unfinished = !found && t + r < end ? 1.0 : 0.0;
    float hit = broken ? b.outer : value <= 0.0 ? min(t + r, ahead) : t;
    return !found ? unfinished > 0.0 ? best : FAR : hit < end ? hit : FAR;
}
