// scenes/csg5.sdf as one would write it for Shadertoy: a distance, a loop, and a normal by four more distances.
float box(vec3 p, vec3 half_size) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

float cylinder(vec3 p, float radius, float half_height) {
    vec2 q = vec2(length(p.xz) - radius, abs(p.y) - half_height);
    return min(max(q.x, q.y), 0.0) + length(max(q, 0.0));
}

float map(vec3 p) {
    float solid = max(box(p, vec3(0.8)), length(p) - 1.05);
    float rods = min(cylinder(p.yxz, 0.5, 1.5), min(cylinder(p, 0.5, 1.5), cylinder(p.xzy, 0.5, 1.5)));
    return max(solid, -rods);
}

vec3 normal_at(vec3 p) {
    vec2 e = vec2(1.0, -1.0) * 0.0005;
    return normalize(e.xyy * map(p + e.xyy) + e.yyx * map(p + e.yyx) + e.yxy * map(p + e.yxy) + e.xxx * map(p + e.xxx));
}

// xyz the normal, w the distance; below 0 where there is nothing
vec4 march(vec3 origin, vec3 direction) {
    float t = 0.0;
    for (int i = 0; i < 256; i++) {
        vec3 p = origin + t * direction;
        float d = map(p);
        if (d < 0.0002 * t) return vec4(normal_at(p), t);
        t += d;
        if (t > 100.0) break;
    }
    return vec4(-1.0);
}
