#version 450 core
// The rays themselves, as every tracer has them: what truth is proved of, and what a frame costs that traces nothing.
noperspective in vec3 ray_origin;
noperspective in vec3 ray_ahead;
layout(location = 0) out vec4 origin_out;
layout(location = 1) out vec4 direction_out;
void main() {
    origin_out = vec4(ray_origin, 0.0);
    direction_out = vec4(normalize(ray_ahead), 0.0);
}
