#version {{ version }}
uniform mat4 clip_from_scene;  // projection * view * model
uniform mat4 scene_from_clip;  // its inverse

const float RADIUS = {{ radius }};
const vec3 CENTRE = {{ centre }};
const vec3 BOX_LOW = {{ box_low }};  // in the scene's own coordinates: (p - centre) / radius
const vec3 BOX_HIGH = {{ box_high }};

out vec4 near_point;
out vec4 far_point;
flat out vec4 depth_row;
flat out vec4 weight_row;

vec4 own(vec4 place) { return vec4((place.xyz - CENTRE * place.w) / RADIUS, place.w); }

void main() {
    int corner = 1 << gl_VertexID;  // of fourteen: a strip around the box
    vec3 side = vec3((0x287a & corner) != 0, (0x02af & corner) != 0, (0x31e3 & corner) != 0);
    gl_Position = clip_from_scene * vec4(RADIUS * mix(BOX_LOW, BOX_HIGH, side) + CENTRE, 1.0);
    near_point = own(scene_from_clip * vec4(gl_Position.xy, -gl_Position.w, gl_Position.w));
    far_point = own(scene_from_clip * vec4(gl_Position.xyww));
    depth_row = vec4(clip_from_scene[0].z, clip_from_scene[1].z, clip_from_scene[2].z, clip_from_scene[3].z);
    weight_row = vec4(clip_from_scene[0].w, clip_from_scene[1].w, clip_from_scene[2].w, clip_from_scene[3].w);
}
