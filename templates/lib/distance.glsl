float box_distance(vec3 p, vec3 half_size) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

// a value that is a bound inside a box (and a margin around it) only
float within(float box, float value, float margin) { return box > margin ? box : value; }

// the same, with no jump where the margin ends: as steep as the steeper of the two
float within_steadily(float box, float value, float margin) {
    return box > margin ? box : max(box, min(value, 2.0 * margin - box));
}

float far_outside(vec3 p, vec3 half_size) { return any(greaterThan(abs(p), half_size)) ? FAR : -FAR; }
