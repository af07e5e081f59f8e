// Steps of what has no closed form: each answers with the next parameter that is worth a look, t itself for a hit.
const int MOST_STEPS = {{ most_steps }};  // all loops of a pixel together stay below 65 535, where llvmpipe stops them

// v: the value of a convex function and its slope along the ray; its tangent cannot overshoot
float tangent(float t, vec2 v, float eps) {
    float fall = 2.4e-7 - v.y;
    return v.x <= eps ? t : fall > 0.0 ? t + (v.x - 0.5 * eps) / fall * 0.9999996 : FAR;
}

// where the line of a value and its slope comes down to `level`
float line_root(vec2 v, float level) { return v.y < 0.0 ? min(max(v.x - level, 0.0) / -v.y, FAR) : FAR; }

// nothing is nearer than r
float ball(float t, float r, float eps) { return r <= eps ? t : t + r * 0.9999996; }

// Between the ends (`beside` < 0) the field comes down by no more than the ray goes across its walls. At an end it need
// not: what is sunk there, by less than 4 eps, would be passed.
float drawn(float t, float r, float beside, float across, float eps) {
    float clear = beside < -4.0 * eps ? r / (across + 1e-6) : r;
    return r <= eps ? t : t + clear * 0.9999996;
}

// Nothing is nearer than r; v: what has the field's sign, and its slope along the ray, and bends down by no more than
// `bend`. It is there when both are as near as eps: a field may be far flatter than its Lipschitz constant says.
float parabola(float t, float r, vec2 v, float bend, float eps) {
    float above = max(v.x, 0.0);
    float fall = 2.4e-7 + 1e-6 * abs(v.y) - v.y;
    float root = sqrt(fall * fall + 2.0 * bend * above);
    float clear = fall > 0.0 ? 2.0 * above / (fall + root) : (root - fall) / bend;
    clear = v.x > 0.0 ? clear : 0.0;
    return max(r, clear) <= eps ? t : t + max(r, clear) * 0.9999996;
}

// The same where the solid is looked for `sunk` deeper. Next to its face, and within the layer between, the parabola must
// come down as far by the core's own measure: a ray that runs along the layer would creep. It is known to hold down to
// `deep`. The core is `per` as much as r, where that is known; on the face itself its slope says it, if there is any.
float sunk_parabola(float t, float r, vec2 v, float bend, float per, float sunk, float deep, float eps) {
    float measure = per > 0.0 ? per : r != 0.0 ? v.x / r : abs(v.y) > 1e-5 ? abs(v.y) : 1.0;
    float layer = max(sunk - eps, 0.0) * measure;
    return parabola(t, sunk + r, vec2(v.x + (r < eps ? min(layer, deep) : 0.0), v.y), bend, eps);
}

// v: the value, `least` of which is the radius within which nothing is nearer; `span`: what is known of it over the piece
// of the ray that is `ahead` long, which is left as long as the next look should be. The solid is looked for a length
// `sunk` deeper. It is there where no more than eps is clear of so short a piece: the slope near by counts, not the
// steepest.
float piece(float t, inout float ahead, float v, vec4 span, float least, float sunk, float eps) {
    float depth = sunk * max(max(-span.w, span.z), 0.0);  // it falls, or has risen, by this in the length `sunk`
    float above = v + depth, fall = max(-span.z, 1e-30);
    bool empty = above > 0.0 && (span.x + depth > 0.0 || span.z >= 0.0);
    float clear = max(empty ? ahead : min(ahead, max(above, 0.0) / fall), above * least);
    float root = span.w < 0.0 ? min(ahead, max(above, 0.0) / -span.w) : ahead;
    bool there = above <= 0.0 || clear <= eps && root <= 4.0 * eps;
    float shorter = span.w < 0.0 ? root - clear : max(2.0 * clear, 0.25 * ahead);
    ahead = max(empty ? 2.0 * ahead : shorter, 4.0 * eps);
    // where too long a piece says nothing, a shorter one is looked at from the very next number
    return there ? t : t + max(clear * 0.9999996, 1.2e-7 * max(1.0, abs(t)));
}

// outside a convex function, from within: how far its tangent, or the end of its box, says to look ...
float chord_reach(float t, vec2 v, float box_end, float most, float eps) {
    float depth = 3.0 * eps - v.x;
    return clamp(v.y > 1e-6 ? depth / v.y : FAR, 0.0, min(max(box_end - t, 0.0), most));
}

// ... and how far is clear: all of it where its end is still within, else up to the chord's root. `most` is left as how
// far to look next: half as far where that was little, for along a wall chords alone would creep.
float chord(float t, float value, float reach, float value_there, float eps, inout float most) {
    float depth = 3.0 * eps - value, depth_there = 3.0 * eps - value_there;
    float clear = depth_there > 0.0 ? reach : reach * depth / max(depth - depth_there, 1e-30);
    most = depth <= eps ? FAR : clear < 0.5 * reach ? 0.5 * reach : 2.0 * max(clear, eps);
    return depth <= eps ? t : t + max(clear, 0.5 * eps) * 0.9999996;
}

// a part that matters only inside a box
float inside(vec2 box, float t, float next) { return t < box.x ? box.x : next < box.y ? next : FAR; }

vec2 box_interval(vec3 o, vec3 d, vec3 half_size) {
    vec3 safe = mix(d, vec3(1e-18), lessThan(abs(d), vec3(1e-18)));
    vec3 middle = -o / safe, reach = half_size / abs(safe);
    vec3 enters = middle - reach, leaves = middle + reach;
    float first = max(max(enters.x, enters.y), enters.z), last = min(min(leaves.x, leaves.y), leaves.z);
    return first < last ? vec2(first, last) : vec2(FAR, -FAR);
}

// where one coordinate of a ray is between two
vec2 slab_interval(float o, float d, vec2 between) {
    vec2 ends = (between - o) / (abs(d) < 1e-18 ? 1e-18 : d);
    return vec2(min(ends.x, ends.y), max(ends.x, ends.y));
}
