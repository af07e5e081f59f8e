// Moves the origin along the ray to near the scene's, and returns how far: by most of it, then by most of what is left.
// The products are exact (few digits each), and so are all sums but the last: a far eye costs no accuracy (Dekker 1971),
// and t is small where the scene is.
float rebase(inout vec3 o, vec3 d) {
    vec3 head = intBitsToFloat(floatBitsToInt(d) & 0xFFFFF000), tail = d - head;
    float most = intBitsToFloat(floatBitsToInt(-dot(o, d)) & 0xFFFFE000);
    vec3 coarse = o + most * head, rest = most * tail;
    float more = intBitsToFloat(floatBitsToInt(-dot(coarse + rest, d)) & 0xFFFFE000);
    o = ((coarse + more * head) + rest) + more * tail;
    return most + more;
}
