#version 450 core
// Four passes over a table of 64 rows, as unions of many like parts are.
layout(location = 0) out vec4 result;

const vec4 rows[64] = vec4[](
{%- for i in range(64) %}vec4({{ "%.3f" % (i * 7 % 64 / 64) }}, {{ "%.3f" % (i * 11 % 64 / 64) }}, {{ "%.3f" % (i * 23 % 64 / 64) }}, 0.1){{ ", " if not loop.last }}{% endfor -%}
);

void main() {
    vec3 p = vec3(gl_FragCoord.xy * 0.01, 1.0);
    float d = 1e9;
    int count = 0;
    do {
        vec4 row = rows[count & 63];
        vec3 q = row.xyz - p;
        d = min(d, length(q) - row.w);
        count += 1;
    } while (count < 256);
    result = vec4(d, 0.0, 0.0, 1.0);
}
