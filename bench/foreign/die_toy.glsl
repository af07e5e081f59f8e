// scenes/die.sdf as one would write it for Shadertoy: each die in its own frame, and the pips of the face that is near.
const float rounding = 0.10, spin = 0.48869219;  // 28 degrees

vec2 turned(vec2 p, float angle) {
    float c = cos(angle), s = sin(angle);
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

float pip(vec3 p, vec2 at) { return length(p - vec3(at, 0.54)) - 0.115; }

// p looks at the face along +z
float one(vec3 p) { return pip(p, vec2(0.0)); }
float two(vec3 p) { return min(pip(p, vec2(-0.26, 0.26)), pip(p, vec2(0.26, -0.26))); }
float three(vec3 p) { return min(one(p), two(p)); }
float four(vec3 p) { return min(two(p), min(pip(p, vec2(0.26)), pip(p, vec2(-0.26)))); }
float five(vec3 p) { return min(one(p), four(p)); }
float six(vec3 p) { return min(four(p), min(pip(p, vec2(-0.26, 0.0)), pip(p, vec2(0.26, 0.0)))); }

float pips(vec3 p) {
    float d = min(one(vec3(p.x, -p.z, p.y)), six(vec3(p.x, p.z, -p.y)));
    d = min(d, min(two(p), five(vec3(-p.x, p.y, -p.z))));
    return min(d, min(three(vec3(-p.z, p.y, p.x)), four(vec3(p.z, p.y, -p.x))));
}

float die(vec3 p) {
    vec3 q = abs(p) - (0.5 - rounding);
    float cube = length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0) - rounding;
    float body = max(cube, length(p) - 0.78);
    return max(body, -pips(p));
}

float map(vec3 p) {
    vec3 a = p - vec3(0.42, 0.5, 0.3), b = p - vec3(-0.95, 0.5, -0.25), c = p - vec3(0.45, 0.5, -1.3);
    a.xz = turned(a.xz, spin - 0.66322512);
    b.xz = turned(b.xz, 1.9 * spin);
    c.xz = turned(c.xz, 0.4 * spin);
    return min(p.y, min(die(a), min(die(vec3(b.y, -b.x, b.z)), die(vec3(c.x, -c.z, c.y)))));
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
