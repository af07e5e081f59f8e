// The ray of a point of the picture, in pixels from its lower left corner. cone.z is 1 in perspective, 0 in parallel.
void camera_ray(vec2 pixel, out vec3 o, out vec3 d) {
    vec2 at = (pixel + window.zw) / window.xy * 2.0 - 1.0;
    vec3 across = at.x * axis_x + at.y * axis_y;
    o = eye + (1.0 - cone.z) * across;
    d = normalize(axis_z + cone.z * across);
}

// Moves the origin along the ray to near the scene's, and returns how far. The products are exact (few digits each), so
// that a far eye costs no accuracy (Dekker 1971).
float rebase(inout vec3 o, vec3 d) {
    float t = intBitsToFloat(floatBitsToInt(-dot(o, d)) & 0xFFFFE000);
    vec3 head = intBitsToFloat(floatBitsToInt(d) & 0xFFFFF000);
    o = (o + t * head) + t * (d - head);
    return t;
}
