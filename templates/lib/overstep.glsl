// requires: map (generated), tolerance, haste (the tracer's: how many radii to look ahead)
// provides: trace, by steps beyond the ball that proves them, taken back where the balls do not meet (Keinert 2014)
float trace(vec3 o, vec3 d, float start, float limit) {
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    float t = start, r = 0.0;          // [start, t + r) is proven empty
    float z = 0.0, slope = -1.0;       // the next look is at t + z
    float ahead = FAR, value = 0.0;    // a look beyond what is proven, and its value
    float best = FAR, least = {{ parameter.force }};  // where the ray came nearest, in tolerances
    int count = 0;
    bool found, broken = false;
    do {
        float at = t + z, v = map(o + at * d), eps = tolerance(at);
        bool moves = v >= 0.0 && z <= r + v + rounding(at);
        ...
    } while (!found && t + r < end && count < MOST_STEPS);
}
