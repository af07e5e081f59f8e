#version {{ version }}
{% include "entry/scene.glsl" %}

layout(location = 0) out vec4 start_out;  // up to this far from the eye, no ray of the tile meets anything; steps

const float TILE = {{ tile }}.0;  // pixels
const int MOST_CONE_STEPS = 96;

// All rays of a tile are within `spread` of its middle ray: a ball around that ray's point, proven empty, is theirs too.
void main() {
    prepare();
    vec2 first = TILE * floor(gl_FragCoord.xy);
    vec3 o, d, corner_o, corner_d;
    tile_ray(first + 0.5 * TILE, o, d);
    vec2 spread = vec2(0.0);  // at the eye, and its growth with the distance
    int corner = 0;
    do {  // half a pixel wider: samples lie anywhere in their pixels
        vec2 side = vec2(corner & 1, corner >> 1) * 2.0 - 1.0;
        tile_ray(first + 0.5 * TILE + (0.5 * TILE + 0.5) * side, corner_o, corner_d);
        spread = max(spread, vec2(length(corner_o - o), length(corner_d - d)));
        corner += 1;
    } while (corner < 4);
    spread = 1.0001 * spread + 1e-6;
    travelled = rebase(o, d);
{% if sweep_is_finite %}
    // what is swept lies within 1 of the scene's origin, which the middle ray passes at `foot`
    float foot = travelled - dot(o, d);
    float reach = max(0.0, (foot - 1.0001 - spread.x) / (1.0 + spread.y));
    float last = (foot + 1.0001 + spread.x) / max(1.0 - spread.y, 1e-6);
{% else %}
    float reach = 0.0, last = {{ horizon }};
{% endif %}
    float free, width;
    int count = 0;
    do {
        vec3 p = o + (reach - travelled) * d;
        width = spread.x + spread.y * reach;
        // as sure as float32 is of numbers of this size
        free = map(p) - width - 1e-6 * max(1.0, length(p));
        reach += max(free, 0.0) / (1.0 + spread.y);
        count += 1;
    } while (free > 0.25 * width && reach < last && count < MOST_CONE_STEPS);
    start_out = vec4({{ "reach < last ? reach : FAR" if sweep_is_finite else "reach" }}, float(count), 0.0, 0.0);
}
