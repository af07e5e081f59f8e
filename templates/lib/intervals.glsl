// Intervals of the ray's parameter: vec2(enter, leave), vec4 for two in order; an empty one leaves at -FAR.
const float FAR = {{ far }};
const float GROW = {{ grow }};  // solids are this much larger: parts that touch leave no crack
const float CUT = {{ cut }};  // what is cut away is this much larger: faces that coincide leave no film

// the first parameter at or after t inside the interval
float enter(vec2 v, float t) { return t < v.y ? max(t, v.x) : FAR; }
float enter(vec4 v, float t) { return min(enter(v.xy, t), enter(v.zw, t)); }

// the first parameter at or after t outside it
float leave(vec2 v, float t) { return t < v.x || t >= v.y ? t : v.y; }
float leave(vec4 v, float t) { return leave(v.zw, leave(v.xy, t)); }

// what is in both
vec2 both(vec2 u, vec2 v) {
    vec2 w = vec2(max(u.x, v.x), min(u.y, v.y));
    return w.x < w.y ? w : vec2(FAR, -FAR);
}

// Convex solids in xy, their cores in zw. A run counts where all but one hold it by their cores: solids that only touch
// share their skins, at any slant, but neither's core meets the other's skin.
vec4 meeting(vec4 u, vec4 v) {
    vec2 first = both(u.xy, v.zw), second = both(u.zw, v.xy);
    return vec4(min(first.x, second.x), max(first.y, second.y), both(u.zw, v.zw));
}
