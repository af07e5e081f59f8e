{% set plain = parameter.plain == "1.0" %}
{% include "lib/refine.glsl" %}

// requires: map (generated), refine
// provides: trace, by sphere tracing with a least step, to the first look at the inside; then so many refinements (Liktor
// 2008, section 5.4 and listing 2, with a bracket whose both ends were looked at). A run of solid that is nowhere deeper
// than half the least step may be lost.
float trace(vec3 o, vec3 d, float start, float limit) {
    float end = min(limit, {{ "1.0001 - dot(o, d)" if finite else horizon }});  // nothing of the scene lies beyond
    float at = start, t = start, r = 0.0;
    Bracket b = bracket(0.0, 1.0, 1.0, 0.0);
    float left = -1.0;  // refinements; below 0 while there is no bracket
    int count = 0, state = 0;  // 1 a hit, 2 a miss
    do {
        float v = map(o + at * d);
        bool bracketed = left >= 0.0, enters = !bracketed && v <= 0.0;
        float pace = max(v, max({{ parameter.min_step }} * (cone.x + cone.y * (travelled + at)), rounding(at)));
        Bracket fresh = bracket(t, r, at, v), less = narrowed(b, at, v);
        b = bracketed ? less : enters ? fresh : b;
        left = bracketed ? left - 1.0 : enters ? {{ parameter.refinements }} : left;
        t = bracketed || enters ? t : at;
        r = bracketed || enters ? r : v;
        at = bracketed || enters ? look(b) : at + pace;
        steps += 1.0;
        evaluations += 1.0;
        count += 1;
        // kept from one pass to the next: llvmpipe forgets what a ray that is done knew but does not keep
        state = left >= 0.0 ? (left > 0.0 && b.inner > b.outer ? state : 1) : at < end ? state : 2;
    } while (state == 0 && count < MOST_STEPS);
    unfinished = state == 0 ? 1.0 : 0.0;
    return state != 2 && left >= 0.0 && at < end ? at : FAR;
}
