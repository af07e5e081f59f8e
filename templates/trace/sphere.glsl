// requires: map (generated), tolerance
// provides: trace, by sphere tracing (Hart 1996)
float trace(vec3 o, vec3 d, float start, float limit) {
    float t = start, r, eps;
    int count = 0;
    do {
        r = map(o + t * d);
        eps = tolerance(t);
        t += r > eps ? r : 0.0;
        steps += 1.0;
        count += 1;
    } while (r > eps && t < limit && count < MOST_STEPS);
    return t < limit ? t : FAR;
}
