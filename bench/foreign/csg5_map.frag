// scenes/csg5.sdf as one would write it by hand: a distance in the scene's own units, and three numbers that were tried
// until the picture looked right.
#define STEP_FACTOR 0.9
#define EPSILON 0.001
#define MAX_STEPS 128

float box(vec3 p, vec3 half_size) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

float rod(vec3 p) { return max(length(p.xz) - 0.5, abs(p.y) - 1.5); }

float map(vec3 p) {
    float solid = max(box(p, vec3(0.8)), length(p) - 1.05);
    return max(solid, -min(rod(p.yxz), min(rod(p), rod(p.xzy))));
}
