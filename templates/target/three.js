{% for line in header %}
// {{ line }}
{% endfor %}

import { BackSide, BoxGeometry, GLSL3, Mesh, ShaderMaterial } from "three";

{% include "target/three_params.js" %}

const vertexShader = /* glsl */ `
const float RADIUS = {{ radius }};
const vec3 CENTRE = {{ centre }};

out vec4 {{ brief.prefix }}_near_point;
out vec4 {{ brief.prefix }}_far_point;
flat out vec4 {{ brief.prefix }}_depth_row;
flat out vec4 {{ brief.prefix }}_weight_row;

vec4 own(vec4 place) { return vec4((place.xyz - CENTRE * place.w) / RADIUS, place.w); }

void main() {
  mat4 clip_from_scene = projectionMatrix * modelViewMatrix, scene_from_clip = inverse(clip_from_scene);
  gl_Position = clip_from_scene * vec4(position, 1.0);
  {{ brief.prefix }}_near_point = own(scene_from_clip * vec4(gl_Position.xy, -gl_Position.w, gl_Position.w));
  {{ brief.prefix }}_far_point = own(scene_from_clip * gl_Position.xyww);
  {{ brief.prefix }}_depth_row = vec4(clip_from_scene[0].z, clip_from_scene[1].z, clip_from_scene[2].z, clip_from_scene[3].z);
  {{ brief.prefix }}_weight_row = vec4(clip_from_scene[0].w, clip_from_scene[1].w, clip_from_scene[2].w, clip_from_scene[3].w);
}
`;

const fragmentShader = /* glsl */ `
{{ text | in_template_literal }}`;

export const material = new ShaderMaterial({ glslVersion: GLSL3, side: BackSide, uniforms, vertexShader, fragmentShader });

// The box that holds the scene, in the scene's own coordinates.
export const geometry = new BoxGeometry({{ box_size }}).translate({{ box_centre }});

export function createMesh() {
  return new Mesh(geometry, material);
}
