{{ shading_functions }}
const vec3 UP = {{ up }};

vec3 sky(vec3 d) { return sky_radiance(d, UP, {{ sky }}); }

{% if lights %}
// Light number `light` at a point: the way to it, how far it is, and its irradiance there.
void light_at(int light, vec3 p, out vec3 toward, out float reach, out vec3 irradiance) {
{% for light in lights %}
{% if loop.length == 1 %}
{% for line in light.lines %}
    {{ line }}
{% endfor %}
{% else %}
    {{ "" if loop.first else "else " }}{{ "" if loop.last else "if (light == %d) " % loop.index0 }}{
{% for line in light.lines %}
        {{ line }}
{% endfor %}
    }
{% endif %}
{% endfor %}
}

{% endif %}
{% if not is_convex %}
// How open the sky is over a point, from distances along the normal.
float openness(vec3 p, vec3 normal) {
{% if occluder %}
    vec4 heights = {{ occlusion_heights }}, left = heights, distances = vec4(0.0);
    int taps = 0;
    do {
        distances = vec4(distances.yzw, {{ occluder }}(p + left.x * normal{{ ", left.x" if occluder_is_limited }}));
        left = left.yzwx;
        taps += 1;
    } while (taps < 4);
    return occlusion_weight(distances, heights);
{% else %}
    return 1.0;
{% endif %}
}

{% endif %}
{% if shadows %}
{% include "lib/clearance.glsl" %}

{% endif %}
{% if shadows %}
// One loop, one call of trace: the ray of the eye first, then one to each light.
{% elif lights %}
// All of it is one convex solid: nothing stands between its surface and what lights it (Keinert 2014, section 3.5).
{% endif %}
vec4 radiance() {
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
{% if prepass %}
    look_up_tile();
{% endif %}
    float start = {{ first_start }}, limit = FAR;
    vec3 view = -d, p = vec3(0.0), normal = vec3(0.0), toward = vec3(0.0), irradiance = vec3(0.0), seen = vec3(0.0);
    Surface s;
    bool hit = false;
    int light = -1;
{% if shadows %}
    float lift = 0.0;
{% endif %}
    do {
        float t = trace(o, d, start, limit);
        if (light < 0) {
            hit = t < FAR;
            p = o + t * d;
            s = surface(hit ? p : vec3(0.0), d, rounding(hit ? t : 0.0));
{% filter indent(12, true) %}
{% include "shade/polish.glsl" %}
{% endfilter %}
            normal = normalize(s.field.xyz);
            normal = dot(normal, view) > 0.0 ? normal : normalize(normal - 1.001 * dot(normal, view) * view);
            travelled += t;
{% if shadows %}
            lift = clearance(s.field.w - slope * correction, steepness);
        } else if (t >= limit) {
            seen += irradiance * reflect_light(normal, view, toward, {{ surface.properties.color }}, {{ surface.properties.metallic }}, {{ surface.properties.roughness }});
{% endif %}
        }
        light += 1;
{% if shadows %}
        o = p + lift * normal;
        light_at(light, o, toward, limit, irradiance);
        d = toward;
        start = 0.0;
{% if prepass %}
        cleared = -FAR;
{% endif %}
{% endif %}
    } while (hit && light < {{ shadows | length }});
    if (!hit) {
        return vec4(sky(-view){% for light in suns %} + sun_disc(-view, {{ light.toward }}) * {{ light.radiance }}{% endfor %}, 0.0);
    }
{% if lights and not shadows %}
    do {
        light_at(light, p, toward, limit, irradiance);
        seen += irradiance * reflect_light(normal, view, toward, {{ surface.properties.color }}, {{ surface.properties.metallic }}, {{ surface.properties.roughness }});
        light += 1;
    } while (light < {{ lights | length }});
{% endif %}
    seen += ambient(normal, view, UP, {{ surface.properties.color }}, {{ surface.properties.metallic }}, {{ surface.properties.roughness }}, {{ "1.0" if is_convex else "openness(p, normal)" }}, {{ sky }});
{% if transmission %}
    vec3 clear = transmit(normal, view, UP, {{ surface.properties.ior }}, {{ surface.properties.tint }}, {{ sky }});
    seen = mix(seen, clear, {{ surface.properties.transmission }});
{% endif %}
    return vec4(seen{{ "" if surface.properties.emission == "vec3(0.0)" else " + " ~ surface.properties.emission }}, 1.0);
}
