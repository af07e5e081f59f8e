noperspective in vec3 ray_origin;  // of this pixel, from the vertex stage
noperspective in vec3 ray_ahead;
flat in vec2 ray_cone;  // half a pixel: size at the eye, growth with the distance

vec2 cone;

void camera_ray(out vec3 o, out vec3 d) {
    o = ray_origin;
    d = normalize(ray_ahead);
    cone = ray_cone;
}
