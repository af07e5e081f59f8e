uniform vec3 eye;     // in the scene's own coordinates: (p - centre) / radius
uniform vec3 axis_x;  // to the right edge of the picture, to its upper edge, and ahead
uniform vec3 axis_y;
uniform vec3 axis_z;
uniform vec4 window;  // width, height, and the sample's place in its pixel
uniform vec3 pixel;   // half a pixel: size at the eye, growth with the distance; 1 in perspective, 0 in parallel

vec2 cone;

// the ray at a place in the picture, in pixels from the lower left
void tile_ray(vec2 place, out vec3 o, out vec3 d) {
    vec2 at = place / window.xy * 2.0 - 1.0;
    vec3 across = at.x * axis_x + at.y * axis_y;
    o = eye + (1.0 - pixel.z) * across;
    d = normalize(axis_z + pixel.z * across);
    cone = pixel.xy;
}
