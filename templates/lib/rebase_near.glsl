// Moves the origin along the ray to near the scene's, and returns how far. The products are exact (few digits each). The
// eye is near: what is left of the way is short already.
float rebase(inout vec3 o, vec3 d) {
    float t = intBitsToFloat(floatBitsToInt(-dot(o, d)) & 0xFFFFE000);
    vec3 head = intBitsToFloat(floatBitsToInt(d) & 0xFFFFF000);
    o = (o + t * head) + t * (d - head);
    return t;
}
