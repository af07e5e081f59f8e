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

// what is in both; a run no longer than what two skins share is the face of two solids that only touch
vec2 both(vec2 u, vec2 v) {
    vec2 w = vec2(max(u.x, v.x), min(u.y, v.y));
    return w.x + 4.0 * GROW < w.y ? w : vec2(FAR, -FAR);
}
