// requires: map (generated), tolerance
// provides: trace, by sphere tracing as published (Hart 1996): no bounding volume, but a far plane that is proven
float trace(vec3 o, vec3 d, float start, float limit) {
    float t = start, r, eps;
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    int count = 0;
    do {
        r = map(o + t * d);
        eps = tolerance(t);
        t += r > eps ? r : 0.0;
        steps += 1.0;
        evaluations += 1.0;
        count += 1;
    } while (r > eps && t < end && count < MOST_STEPS);
    unfinished = r > eps && t < end ? 1.0 : 0.0;
    return t < end ? t : FAR;
}
