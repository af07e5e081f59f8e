// scenes/csg5.sdf without marching: what of the ray is in the box and in the ball, less what is in a rod (Roth 1982).
layout(location = 0) out vec4 depth_out;

vec2 slab(float o, float d, float reach) {
    float middle = -o / d, half_way = abs(reach / d);
    return vec2(middle - half_way, middle + half_way);
}

vec2 both(vec2 u, vec2 v) { return vec2(max(u.x, v.x), min(u.y, v.y)); }

// |o + t d|^2 = r^2, for a ball's vectors or those of a rod's cross section
vec2 round_interval(float dd, float od, float oo, float r) {
    float root = od * od - dd * (oo - r * r);
    return root < 0.0 ? vec2(1e9, -1e9) : (vec2(-1.0, 1.0) * sqrt(root) - od) / dd;
}

vec2 rod(vec3 o, vec3 d) {
    vec2 across = round_interval(dot(d.xz, d.xz), dot(o.xz, d.xz), dot(o.xz, o.xz), 0.5);
    return both(across, slab(o.y, d.y, 1.5));
}

float past(float t, vec2 hole) { return t < hole.x || t > hole.y ? t : hole.y; }

void main() {
    vec3 o = ray_origin, d = normalize(ray_ahead);
    vec2 solid = both(slab(o.x, d.x, 0.8), both(slab(o.y, d.y, 0.8), slab(o.z, d.z, 0.8)));
    solid = both(solid, round_interval(1.0, dot(o, d), dot(o, o), 1.05));
    float t = max(solid.x, 0.0);
    for (int i = 0; i < 3; ++i) t = past(past(past(t, rod(o.yxz, d.yxz)), rod(o, d)), rod(o.xzy, d.xzy));
    depth_out = t < solid.y ? vec4(t, 1.0, 0.0, 1.0) : vec4(-1.0, 1.0, 0.0, 0.0);
}
