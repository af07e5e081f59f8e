#version {{ version }}
// One triangle over the picture. The ray is linear in the pixel: what is interpolated costs a fragment less than a
// uniform does (on llvmpipe every uniform is gathered lane by lane).
uniform vec3 eye;
uniform vec3 axis_x;
uniform vec3 axis_y;
uniform vec3 axis_z;
uniform vec4 window;
uniform vec3 pixel;

noperspective out vec3 ray_origin;
noperspective out vec3 ray_ahead;
flat out vec2 ray_cone;

void main() {
    vec2 at = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    gl_Position = vec4(at, 0.0, 1.0);
    vec2 moved = at + 2.0 * window.zw / window.xy;
    vec3 across = moved.x * axis_x + moved.y * axis_y;
    ray_origin = eye + (1.0 - pixel.z) * across;
    ray_ahead = axis_z + pixel.z * across;
    ray_cone = pixel.xy;
}
