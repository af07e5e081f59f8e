const vec3 BOX_LOW = {{ box_low }};  // in the scene's own coordinates: (p - centre) / radius
const vec3 BOX_HIGH = {{ box_high }};

in vec4 near_point;  // where this pixel's ray begins and ends, in the scene's own coordinates, homogeneous
in vec4 far_point;
flat in vec4 depth_row;  // of the matrix to clip space, of the scene's units
flat in vec4 weight_row;

vec2 cone;
float entry;  // where the ray enters the box, and where it leaves it
float gone;

// the ray of this pixel
void camera_ray(out vec3 o, out vec3 d) {
    o = near_point.xyz / near_point.w;
    d = normalize(far_point.xyz * near_point.w - near_point.xyz * far_point.w);
    cone = 0.5 * vec2(max(length(dFdx(o)), length(dFdy(o))), max(length(dFdx(d)), length(dFdy(d))));
    vec3 safe = mix(d, vec3(1e-18), lessThan(abs(d), vec3(1e-18)));
    vec3 to_low = (BOX_LOW - o) / safe, to_high = (BOX_HIGH - o) / safe;
    vec3 enters = min(to_low, to_high), leaves = max(to_low, to_high);
    entry = max(max(enters.x, max(enters.y, enters.z)), 0.0);
    gone = min(leaves.x, min(leaves.y, leaves.z));
}
