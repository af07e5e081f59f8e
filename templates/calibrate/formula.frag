#version 450 core
// Sixty-four passes over eight boxes, as a marching loop is: 1 for each +, -, *, abs, min and max, 9 for a length.
layout(location = 0) out vec4 result;

float box(vec3 p, vec3 half_size) {  // 3 + 3 + 3 + 9 + 1 + 1 + 1 + 1
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

void main() {
    vec3 p = vec3(gl_FragCoord.xy * 0.01, 1.0);
    float t = 0.0, d;
    int count = 0;
    do {
        vec3 q = p + t;
        d = box(q, vec3(0.1, 0.2, 0.3));
        d = min(d, box(q - vec3(0.4, 0.1, 0.2), vec3(0.3, 0.1, 0.2)));
        d = min(d, box(q - vec3(0.2, 0.5, 0.7), vec3(0.2, 0.3, 0.1)));
        d = min(d, box(q - vec3(0.7, 0.3, 0.1), vec3(0.1, 0.1, 0.3)));
        d = min(d, box(q - vec3(0.3, 0.8, 0.4), vec3(0.3, 0.2, 0.2)));
        d = min(d, box(q - vec3(0.9, 0.2, 0.6), vec3(0.2, 0.2, 0.1)));
        d = min(d, box(q - vec3(0.6, 0.6, 0.3), vec3(0.1, 0.3, 0.3)));
        d = min(d, box(q - vec3(0.1, 0.9, 0.8), vec3(0.2, 0.1, 0.2)));
        t += 1e-3 * d;
        count += 1;
    } while (count < 64);
    result = vec4(t, d, 0.0, 1.0);
}
