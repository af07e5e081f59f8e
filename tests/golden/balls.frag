#version 450 core
// test.sdf, made by sdfc
// tracer: proven. Events of closed-form ray intervals, tangents of convex functions, Lipschitz balls for the rest.

uniform vec3 eye;     // in the scene's own coordinates: (p - centre) / radius
uniform vec3 axis_x;  // to the right edge of the picture, to its upper edge, and ahead
uniform vec3 axis_y;
uniform vec3 axis_z;
uniform vec4 window;  // width, height, and the sample's place in its pixel
uniform vec3 pixel;   // half a pixel: size at the eye, growth with the distance; 1 in perspective, 0 in parallel

vec2 cone;

// the ray of this pixel
void camera_ray(out vec3 o, out vec3 d) {
    vec2 at = (gl_FragCoord.xy + window.zw) / window.xy * 2.0 - 1.0;
    vec3 across = at.x * axis_x + at.y * axis_y;
    o = eye + (1.0 - pixel.z) * across;
    d = normalize(axis_z + pixel.z * across);
    cone = pixel.xy;
}

float steps = 0.0;        // passes of the loops
float evaluations = 0.0;  // values of the whole scene that they took
float unfinished = 0.0;   // 1 where a ray was given up at MOST_STEPS
float travelled = 0.0;  // along the path, to where the ray at hand has t = 0

void prepare() {
}

// Intervals of the ray's parameter: vec2(enter, leave), vec4 for two in order; an empty one leaves at -FAR.
const float FAR = 1e9;

// the first parameter at or after t inside the interval
float enter(vec2 v, float t) { return t < v.y ? max(t, v.x) : FAR; }

float enter(vec4 v, float t) { return min(enter(v.xy, t), enter(v.zw, t)); }

// How near counts as there, at parameter t of the ray at hand. What converges fast is asked for all that float32 has;
// the rest for a small part of a pixel.
float rounding(float t) { return 1.9073486e-6 * max(1.0, abs(t)); }

float tolerance(float t) { return max(rounding(t), 0.015625 * (cone.x + cone.y * (travelled + t))); }

// Steps of what has no closed form: each answers with the next parameter that is worth a look, t itself for a hit.
const int MOST_STEPS = 2048;  // all loops of a pixel together stay below 65 535, where llvmpipe stops them

// nothing is nearer than r
float ball(float t, float r, float eps) { return r <= eps ? t : t + r * 0.9999996; }

// a part that matters only inside a box
float inside(vec2 box, float t, float next) { return t < box.x ? box.x : next < box.y ? next : FAR; }

vec2 box_interval(vec3 o, vec3 d, vec3 half_size) {
    vec3 safe = mix(d, vec3(1e-18), lessThan(abs(d), vec3(1e-18)));
    vec3 middle = -o / safe, reach = half_size / abs(safe);
    vec3 enters = middle - reach, leaves = middle + reach;
    float first = max(max(enters.x, enters.y), enters.z), last = min(min(leaves.x, leaves.y), leaves.z);
    return first < last ? vec2(first, last) : vec2(FAR, -FAR);
}

// Moves the origin along the ray to near the scene's, and returns how far: by most of it, then by most of what is left.
// The products are exact (few digits each), and so are all sums but the last: a far eye costs no accuracy (Dekker 1971),
// and t is small where the scene is.
float rebase(inout vec3 o, vec3 d) {
    vec3 head = intBitsToFloat(floatBitsToInt(d) & 0xFFFFF000), tail = d - head;
    float most = intBitsToFloat(floatBitsToInt(-dot(o, d)) & 0xFFFFE000);
    vec3 coarse = o + most * head, rest = most * tail;
    float more = intBitsToFloat(floatBitsToInt(-dot(coarse + rest, d)) & 0xFFFFE000);
    o = ((coarse + more * head) + rest) + more * tail;
    return most + more;
}

struct Surface {
    vec4 field;  // gradient and value
    float rank;  // the value of what is traced, a little way back
    float material;
};

Surface farther(Surface a, Surface b) { if (b.rank > a.rank) return b; return a; }

Surface unpainted_material(vec4 field, float rank) {
    return Surface(field, rank, 0.0);
}

// A ring around y: `major` is the ring's radius, `minor` its tube's.
float torus(vec3 p, float major, float minor) {
    return length(vec2(length(p.xz) - major, p.y)) - minor;
}

// Turned around y, more the higher: `rate` is the angle per length.
float twist_1_field(vec3 p) {
    float product = 0.34906584 * p.y;
    float cosine = cos(product);
    float sine = sin(product);
    vec3 q = abs(vec3(cosine * p.x - sine * p.z, p.y, sine * p.x + cosine * p.z)) - vec3(0.5);
    float sum = length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
    float product_2 = 0.34906584 * length(p.xz);
    float sum_2 = product_2 / 2.0 + sqrt(1.0 + product_2 * product_2 / 4.0);
    return 2.0 * sum / (sum_2 + sqrt(sum_2 * sum_2 + 0.6981317 * abs(sum)));
}

// A ring around y: `major` is the ring's radius, `minor` its tube's.
vec4 torus_surface(vec3 p, float major, float minor) {
    float len = length(p.xz);
    vec2 q = vec2(len - major, p.y);
    float len_2 = length(q);
    vec2 q_2 = q / max(len_2, 1e-30);
    vec2 q_3 = p.xz * (q_2.x / max(len, 1e-30));
    return vec4(q_3.x, q_2.y, q_3.y, len_2 - minor);
}

// Turned around y, more the higher: `rate` is the angle per length.
vec4 twist_1_surface(vec3 p) {
    float product = 0.34906584 * p.y;
    float cosine = cos(product);
    float sine = sin(product);
    vec3 q = vec3(cosine * p.x - sine * p.z, p.y, sine * p.x + cosine * p.z);
    vec3 q_2 = abs(q) - vec3(0.5);
    float d = max(q_2.x, max(q_2.y, q_2.z));
    vec3 q_3 = max(q_2, 0.0);
    float len = length(q_3);
    float sum = len + min(d, 0.0);
    float len_2 = length(p.xz);
    float product_2 = 0.34906584 * len_2;
    float root = sqrt(1.0 + product_2 * product_2 / 4.0);
    float sum_2 = product_2 / 2.0 + root;
    float root_2 = sqrt(sum_2 * sum_2 + 0.6981317 * abs(sum));
    float sum_3 = sum_2 + root_2;
    float ratio = 2.0 * sum / sum_3;
    float ratio_2 = 1.0 / sum_3;
    float opposite = -ratio * ratio_2;
    float product_3 = opposite * (0.5 / max(root_2, 1e-30));
    float product_4 = product_3 * sum_2;
    float sum_4 = opposite + product_4 + product_4;
    float product_5 = sum_4 * (0.5 / max(root, 1e-30)) * 0.25 * product_2;
    vec2 q_4 = p.xz * ((product_5 + product_5 + sum_4 * 0.5) * 0.34906584 / max(len_2, 1e-30));
    float sum_5 = product_3 * 0.6981317 * (sum < 0.0 ? -1.0 : 1.0) + ratio_2 * 2.0;
    vec3 q_5 = d <= q_2.z ? vec3(0.0, 0.0, 1.0) : d <= q_2.y ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 q_6 = (d <= 0.0 ? q_5 * sum_5 : vec3(0.0)) + q_3 * (sum_5 / max(len, 1e-30));
    vec3 q_7 = q_6 * sign(sign(q) + 0.5);
    float sum_6 = (q_7.z * p.x + (-q_7.x * p.z)) * cosine + (q_7.z * p.z + q_7.x * p.x) * (-sine);
    float sum_7 = q_4.y + (q_7.z * cosine + (-q_7.x * sine));
    return vec4(q_4.x + (q_7.z * sine + q_7.x * cosine), q_7.y + sum_6 * 0.34906584, sum_7, ratio);
}

float map(vec3 p) {
    float d1 = torus(p, 0.52223295, 0.17407766);
    return max(d1, -(0.87038827 * twist_1_field(p * 1.1489125)));  // test.sdf:1:41
}

// the first hit of what is marched, before `limit`
float march(vec3 o, vec3 d, float start, float limit) {
    int count = 0;
    vec2 bounds_1 = box_interval(o - vec3(0.0, 0.0, 0.0), d, vec3(0.69632065, 0.17408766, 0.69632065));
    float t, next = enter(bounds_1, start);
    do {
        t = next;
        vec3 p = o + t * d;
        float eps = tolerance(t), fine = rounding(t);
        float sunk = 3.0 * rounding(max(t, 0.0));
        next = max(inside(bounds_1, t, ball(t, sunk + torus(p, 0.52223295, 0.17407766), fine)), ball(t, 3.0 * fine - 0.87038827 * twist_1_field(p * 1.1489125), fine));
        steps += 1.0;
        evaluations += 1.0;
        count += 1;
    } while (next > t && next < limit && count < MOST_STEPS);
    unfinished = next > t && next < limit ? 1.0 : 0.0;
    float near = 64.0 * tolerance(t);
    return next >= limit || next - t > near ? FAR : t;
}

// requires: events or march (generated)
// provides: trace, the first hit at or after `start` and before `limit`, or FAR
float trace(vec3 o, vec3 d, float start, float limit) {
    float first = FAR;
    first = min(first, march(o, d, start, min(first, limit)));
    return first < limit ? first : FAR;
}

Surface surface(vec3 p, vec3 d, float fine) {
    vec3 back = -8.0 * fine * d, before = p + back;
    float sunk = 3.0 * fine;  // what is marched, in an intersection
    Surface s1 = unpainted_material(torus_surface(p, 0.52223295, 0.17407766), torus_surface(before, 0.52223295, 0.17407766).w + sunk);
    vec4 g_twist_1 = twist_1_surface(p * 1.1489125);  // test.sdf:1:41
    return farther(s1, unpainted_material(-vec4(g_twist_1.xyz * 1.1489125, g_twist_1.w) * 0.87038827, -0.87038827 * twist_1_surface(before * 1.1489125).w + sunk));
}

// Radiance (VEC3) of the sky along a unit direction.
vec3 sky_radiance(vec3 direction, vec3 up, vec3 zenith, vec3 horizon, vec3 ground) {
    float d = clamp(dot(direction, up), -1.0, 1.0);
    float d_2 = min(0.5 * (d + sqrt(d * d + 0.0001)), 1.0);
    vec3 q = horizon + (zenith - horizon) * (d_2 * 1.17 / (d_2 + 0.17));
    float ratio = (d + 0.34) / 0.15;
    return q + (ground - q) * (0.5 - 0.5 * ratio / sqrt(1.0 + ratio * ratio));
}

// The sun's share (0 to 1) along a unit direction; `toward` is the unit direction of the sun.
float sun_disc(vec3 direction, vec3 toward) {
    float ratio = (1.0 - clamp(dot(direction, toward), -1.0, 1.0)) / 0.00015;
    return min(clamp(2.5 - 2.0 * ratio, 0.0, 1.0) + 0.012 / (1.0 + 0.02 * ratio), 1.0);
}

// BRDF times n·l (VEC3). Unit vectors: normal, view (to the eye), light (to the light).
vec3 reflect_light(vec3 normal, vec3 view, vec3 light, vec3 color, float metallic, float roughness) {
    vec3 q = view + light;
    vec3 halfway = q / sqrt(max(dot(q, q), 1e-12));
    float d = normal.y * halfway.z - normal.z * halfway.y;
    float d_2 = normal.z * halfway.x - normal.x * halfway.z;
    vec3 across = vec3(d, d_2, normal.x * halfway.y - normal.y * halfway.x);
    float rough = clamp(roughness, 0.09, 1.0);
    float alpha = rough * rough;
    float product = clamp(dot(normal, halfway), 0.0, 1.0) * alpha;
    float spread = alpha / (dot(across, across) + product * product + 1e-12);
    float product_2 = alpha * alpha;
    float d_3 = 1.0 - product_2;
    float n_dot_l = clamp(dot(normal, light), 0.0, 1.0);
    float n_dot_v = clamp(dot(normal, view), 0.0001, 1.0);
    float smith_light = n_dot_v * sqrt(n_dot_l * n_dot_l * d_3 + product_2);
    float smith_view = n_dot_l * sqrt(n_dot_v * n_dot_v * d_3 + product_2);
    float d_4 = clamp(1.0 - dot(view, halfway), 0.0, 1.0);
    float product_3 = d_4 * d_4;
    float fresnel = product_3 * product_3 * d_4;
    vec3 q_2 = clamp(color, 0.0, 1.0);
    float d_5 = clamp(metallic, 0.0, 1.0);
    vec3 head_on = vec3(0.04) + (q_2 - vec3(0.04)) * d_5;
    vec3 facets = head_on + (vec3(1.0) - head_on) * fresnel;
    vec3 one_bounce = facets * (spread * spread * 0.15915494 / (smith_light + smith_view));
    float product_4 = (((56.543 * n_dot_l - 123.158) * n_dot_l + 76.425) * n_dot_l - 12.016) * rough;
    float sum = product_4 + (((-122.696 * n_dot_l + 273.082) * n_dot_l - 176.513) * n_dot_l + 29.036);
    float sum_2 = sum * rough + (((82.835 * n_dot_l - 190.177) * n_dot_l + 130.466) * n_dot_l - 22.976);
    float sum_3 = sum_2 * rough + (((-15.85 * n_dot_l + 38.325) * n_dot_l - 28.663) * n_dot_l + 6.033);
    float lost_light = clamp(alpha * sum_3, 0.0, 1.0);
    float sum_4 = 2.6 + 2.4 / (1.0 + 125.0 * rough * alpha);
    float sum_5 = 1.0 + alpha * (7.0 + 15.0 * rough);
    float product_5 = 0.96 * (pow(max(clamp(1.0 - n_dot_l, 0.0, 1.0), 1e-7), sum_4) / sum_5);
    float albedo_light = 0.04 * (1.0 - lost_light) + product_5;
    float product_6 = (((56.543 * n_dot_v - 123.158) * n_dot_v + 76.425) * n_dot_v - 12.016) * rough;
    float sum_6 = product_6 + (((-122.696 * n_dot_v + 273.082) * n_dot_v - 176.513) * n_dot_v + 29.036);
    float sum_7 = sum_6 * rough + (((82.835 * n_dot_v - 190.177) * n_dot_v + 130.466) * n_dot_v - 22.976);
    float sum_8 = sum_7 * rough + (((-15.85 * n_dot_v + 38.325) * n_dot_v - 28.663) * n_dot_v + 6.033);
    float lost_view = clamp(alpha * sum_8, 0.0, 1.0);
    float product_7 = 0.96 * (pow(max(clamp(1.0 - n_dot_v, 0.0, 1.0), 1e-7), sum_4) / sum_5);
    float albedo_view = 0.04 * (1.0 - lost_view) + product_7;
    float product_8 = 3.1415927 * (1.0 - (((0.1146 * rough - 0.1774) * rough - 0.002) * rough + 0.0848));
    vec3 unabsorbed = q_2 * (1.0 - d_5);
    vec3 diffuse = unabsorbed * ((1.0 - albedo_light) * (1.0 - albedo_view) / product_8);
    vec3 q_3 = head_on * 0.95238096 + 0.04761905;
    float sum_9 = (((4.3982 * rough - 11.227) * rough + 8.9283) * rough - 1.7301) * rough + 0.232;
    float lost_mean = alpha * sum_9;
    vec3 q_4 = q_3 * q_3 * (1.0 - lost_mean) / (1.0 - q_3 * lost_mean);
    vec3 more_bounces = q_4 * (lost_light * lost_view / (3.1415927 * lost_mean));
    return (diffuse + one_bounce + more_bounces) * n_dot_l;
}

// Ambient occlusion (1 is open) from distances at heights over the surface, lowest first, same unit.
float occlusion_weight(vec4 distances, vec4 heights) {
    vec4 q = distances / max(heights, 1e-12);
    float product = 0.88 * dot(1.0 - clamp(q / clamp(q.x, 0.25, 1.0), 0.0, 1.0), vec4(0.1, 0.3, 0.33, 0.27));
    return clamp(1.0 - product, 0.0, 1.0);
}

// Radiance (VEC3) from the sky; `occlusion` is 1 in the open and 0 where no sky is seen.
vec3 ambient(vec3 normal, vec3 view, vec3 up, vec3 color, float metallic, float roughness, float occlusion, vec3 zenith, vec3 horizon, vec3 ground) {
    float rough = clamp(roughness, 0.09, 1.0);
    float product = rough * rough;
    float product_2 = 0.35 * product;
    float product_3 = clamp(dot(normal * (2.0 * dot(view, normal)) - view, up), -1.0, 1.0) * (1.0 - product_2);
    float sum = 0.01 + 0.4 * product;
    float d = min(0.5 * (product_3 + sqrt(product_3 * product_3 + sum * sum)), 1.0);
    vec3 q = horizon + (zenith - horizon) * (d * 1.17 / (d + 0.17));
    float ratio = (product_3 + 0.34 * (1.0 - product)) / (0.15 + product_2);
    vec3 sky_mirrored = q + (ground - q) * (0.5 - 0.5 * ratio / sqrt(1.0 + ratio * ratio));
    float n_dot_v = clamp(dot(normal, view), 0.0001, 1.0);
    float product_4 = (((56.543 * n_dot_v - 123.158) * n_dot_v + 76.425) * n_dot_v - 12.016) * rough;
    float sum_2 = product_4 + (((-122.696 * n_dot_v + 273.082) * n_dot_v - 176.513) * n_dot_v + 29.036);
    float sum_3 = sum_2 * rough + (((82.835 * n_dot_v - 190.177) * n_dot_v + 130.466) * n_dot_v - 22.976);
    float sum_4 = sum_3 * rough + (((-15.85 * n_dot_v + 38.325) * n_dot_v - 28.663) * n_dot_v + 6.033);
    float d_2 = clamp(product * sum_4, 0.0, 1.0);
    float d_3 = 1.0 - d_2;
    float sum_5 = 2.6 + 2.4 / (1.0 + 125.0 * rough * product);
    float power = pow(max(clamp(1.0 - n_dot_v, 0.0, 1.0), 1e-7), sum_5);
    float ratio_2 = power / (1.0 + product * (7.0 + 15.0 * rough));
    vec3 q_2 = clamp(color, 0.0, 1.0);
    float d_4 = clamp(metallic, 0.0, 1.0);
    vec3 head_on = vec3(0.04) + (q_2 - vec3(0.04)) * d_4;
    vec3 q_3 = head_on * 0.95238096 + 0.04761905;
    float sum_6 = (((4.3982 * rough - 11.227) * rough + 8.9283) * rough - 1.7301) * rough + 0.232;
    float product_5 = product * sum_6;
    vec3 q_4 = q_3 * q_3 * (1.0 - product_5) / (1.0 - q_3 * product_5) * d_2;
    vec3 reflectance = head_on * max(d_3 - ratio_2, 0.0) + ratio_2 + q_4;
    float d_5 = clamp(occlusion, 0.0, 1.0);
    float unhidden = clamp(pow(max(n_dot_v + d_5, 1e-7), exp(-11.09 * rough - 0.693)) - 1.0 + d_5, 0.0, 1.0);
    vec3 specular = reflectance * sky_mirrored * unhidden;
    float albedo = 0.04 * d_3 + 0.96 * ratio_2;
    vec3 unabsorbed = q_2 * (1.0 - d_4);
    float d_6 = clamp(dot(normal, up), -1.0, 1.0);
    float sum_7 = ((0.0315 * d_6 * d_6 + 0.0461) * d_6 + 0.4485) * d_6 + 0.3687;
    float sum_8 = ((0.0512 * d_6 * d_6 + 0.0794) * d_6 - 0.4207) * d_6 + 0.2954;
    vec3 sky_around = zenith * sum_7 + ground * sum_8 + horizon * (1.0 - sum_7 - sum_8);
    vec3 q_5 = ((2.0404 * unabsorbed - 0.3324) * d_5 + (-4.7951 * unabsorbed + 0.6417)) * d_5;
    vec3 bounced = max(vec3(1.0) * d_5, (q_5 + (2.7552 * unabsorbed + 0.6903)) * d_5);
    vec3 diffuse = unabsorbed * (1.0 - albedo) * sky_around * bounced;
    return diffuse + specular;
}

// Linear radiance to linear 0 .. 1 (AgX).
vec3 tone_map(vec3 color) {
    vec3 q = max(color, 0.0) * 1.6;
    float along = dot(vec3(0.042328242, 0.87846863, 0.07916613), q);
    float along_2 = dot(vec3(0.84247905, 0.0784336, 0.079223745), q);
    vec3 q_2 = log(max(vec3(along_2, along, dot(vec3(0.042375654, 0.0784336, 0.879143), q)), 1e-10));
    vec3 q_3 = clamp((q_2 * 1.442695 + 12.47393) / 16.499998, 0.0, 1.0);
    vec3 q_4 = (((15.5 * q_3 - 40.14) * q_3 + 31.96) * q_3 - 6.868) * q_3 + 0.4298;
    vec3 q_5 = max(clamp(((q_4 * q_3 + 0.1191) * q_3 - 0.00232) / 0.99858, 0.0, 1.0), 1e-7);
    vec3 q_6 = pow(q_5, vec3(1.5));
    vec3 q_7 = vec3(1.0) * dot(q_6, vec3(0.2126, 0.7152, 0.0722));
    vec3 q_8 = q_7 + (q_6 - q_7) * 1.3;
    float along_3 = dot(vec3(-0.052896854, 1.1519032, -0.098961174), q_8);
    float along_4 = dot(vec3(-0.052971635, -0.09804345, 1.1510737), q_8);
    vec3 q_9 = max(vec3(dot(vec3(1.196879, -0.09802088, -0.09902974), q_8), along_3, along_4), 0.0);
    return pow(max(min(q_9, 1.0), 1e-7), vec3(2.2));
}

// Linear 0 .. 1 to sRGB 0 .. 1.
vec3 encode_srgb(vec3 color) {
    vec3 q = clamp(color, 0.0, 1.0);
    vec3 q_2 = 12.92 * q;
    vec3 q_3 = 1.055 * pow(max(q, 1e-7), vec3(0.41666666)) - 0.055;
    float chosen = q.x <= 0.0031308 ? q_2.x : q_3.x;
    return vec3(chosen, q.y <= 0.0031308 ? q_2.y : q_3.y, q.z <= 0.0031308 ? q_2.z : q_3.z);
}

const vec3 UP = vec3(0.0, 1.0, 0.0);

vec3 sky(vec3 d) { return sky_radiance(d, UP, vec3(0.21, 0.32, 0.52), vec3(0.86, 0.88, 0.91), vec3(0.23, 0.225, 0.22)); }

// Light number `light` at a point: the way to it, how far it is, and its irradiance there.
void light_at(int light, vec3 p, out vec3 toward, out float reach, out vec3 irradiance) {
    toward = vec3(-0.12290758, 0.6691306, 0.73291063);
    reach = FAR;
    irradiance = vec3(4.4, 3.916, 3.256);
}

// How open the sky is over a point, from distances along the normal.
float openness(vec3 p, vec3 normal) {
    vec4 heights = vec4(0.012, 0.045, 0.11, 0.22), left = heights, distances = vec4(0.0);
    int taps = 0;
    do {
        distances = vec4(distances.yzw, map(p + left.x * normal));
        left = left.yzwx;
        taps += 1;
    } while (taps < 4);
    return occlusion_weight(distances, heights);
}

// How far along the normal a secondary ray starts: twice what the point at hand may be off the surface, `residual` the value
// there where that is more, but no more than half a pixel (Keinert 2014, section 3.3). A field that is flatter than a
// distance is off by more than it says.
float clearance(float residual, float steepness) {
    float off = min(abs(residual), cone.x + cone.y * travelled);
    return 2.0 * max(max(0.5 * 7.6293945e-6, 2.0 * tolerance(0.0)), off) / clamp(steepness, 0.05, 1.0);
}

// One loop, one call of trace: the ray of the eye first, then one to each light.
vec4 radiance() {
    vec3 o, d;
    camera_ray(o, d);
    travelled = rebase(o, d);
    float start = -travelled, limit = FAR;
    vec3 view = -d, p = vec3(0.0), normal = vec3(0.0), toward = vec3(0.0), irradiance = vec3(0.0), seen = vec3(0.0);
    Surface s;
    bool hit = false;
    int light = -1;
    float lift = 0.0;
    do {
        float t = trace(o, d, start, limit);
        if (light < 0) {
            hit = t < FAR;
            p = o + t * d;
            s = surface(hit ? p : vec3(0.0), d, rounding(hit ? t : 0.0));
            // at a point without a gradient (a cone's tip, a medial axis) the surface faces the eye
            s.field.xyz = dot(s.field.xyz, s.field.xyz) > 1e-28 ? s.field.xyz : -d;
            // one Newton step to the surface itself, off the skin that closes cracks and off the tolerance of marching
            float steepness = length(s.field.xyz), slope = dot(s.field.xyz, d);
            float most = 4.0 * tolerance(t) / clamp(steepness, 0.05, 1.0);
            float correction = slope < -0.05 * steepness ? clamp(s.field.w / slope, -most, most) : 0.0;
            t = hit ? max(t - correction, -travelled) : t;  // never behind the eye
            p = o + t * d;
            normal = normalize(s.field.xyz);
            normal = dot(normal, view) > 0.0 ? normal : normalize(normal - 1.001 * dot(normal, view) * view);
            travelled += t;
            lift = clearance(s.field.w - slope * correction, steepness);
        } else if (t >= limit) {
            seen += irradiance * reflect_light(normal, view, toward, vec3(0.48), 0.0, 0.5);
        }
        light += 1;
        o = p + lift * normal;
        light_at(light, o, toward, limit, irradiance);
        d = toward;
        start = 0.0;
    } while (hit && light < 1);
    if (!hit) {
        return vec4(sky(-view) + sun_disc(-view, vec3(-0.12290758, 0.6691306, 0.73291063)) * (vec3(4.4, 3.916, 3.256)), 0.0);
    }
    seen += ambient(normal, view, UP, vec3(0.48), 0.0, 0.5, openness(p, normal), vec3(0.21, 0.32, 0.52), vec3(0.86, 0.88, 0.91), vec3(0.23, 0.225, 0.22));
    return vec4(seen, 1.0);
}

layout(location = 0) out vec4 color_out;  // sRGB

void main() {
    prepare();
    color_out = vec4(encode_srgb(tone_map(radiance().rgb)), 1.0);
}
