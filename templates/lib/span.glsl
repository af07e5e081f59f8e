// Spans: (least value, greatest value, least slope, greatest slope) over a piece of a ray.
vec4 span_hull(vec4 a, vec4 b) {
    return vec4(min(a.x, b.x), max(a.y, b.y), min(a.z, b.z), max(a.w, b.w));
}

// the slope is that of the lesser where it is known which one that is
vec4 span_union(vec4 a, vec4 b) {
    vec2 slope = a.y < b.x ? a.zw : b.y < a.x ? b.zw : vec2(min(a.z, b.z), max(a.w, b.w));
    return vec4(min(a.xy, b.xy), slope);
}

vec4 span_complement(vec4 a) { return -a.yxwz; }

vec4 span_intersection(vec4 a, vec4 b) { return span_complement(span_union(-a.yxwz, -b.yxwz)); }

// a bound that means something in a box (and a margin around it) only: across its face one bound gives way to another
vec4 span_within(vec4 box, vec4 value, float margin) {
    return box.x > margin ? box : box.y <= margin ? value : vec4(span_hull(box, value).xy, -1.0, 1.0);
}
