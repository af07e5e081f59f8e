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

const float GROW = 2.3841858e-7;  // solids are this much larger: parts that touch leave no crack

// the first parameter at or after t inside the interval
float enter(vec2 v, float t) { return t < v.y ? max(t, v.x) : FAR; }

float enter(vec4 v, float t) { return min(enter(v.xy, t), enter(v.zw, t)); }

// How near counts as there, at parameter t of the ray at hand. What converges fast is asked for all that float32 has;
// the rest for a small part of a pixel.
float rounding(float t) { return 1.9073486e-6 * max(1.0, abs(t)); }

float tolerance(float t) { return max(rounding(t), 0.015625 * (cone.x + cone.y * (travelled + t))); }

vec2 box_interval(vec3 o, vec3 d, vec3 half_size) {
    vec3 safe = mix(d, vec3(1e-18), lessThan(abs(d), vec3(1e-18)));
    vec3 middle = -o / safe, reach = half_size / abs(safe);
    vec3 enters = middle - reach, leaves = middle + reach;
    float first = max(max(enters.x, enters.y), enters.z), last = min(min(leaves.x, leaves.y), leaves.z);
    return first < last ? vec2(first, last) : vec2(FAR, -FAR);
}

float box_distance(vec3 p, vec3 half_size) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
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
    float material;
};

Surface unpainted_material(vec4 field) {
    return Surface(field, 0.0);
}

// A ball around the origin.
vec2 sphere_ray(vec3 o, vec3 d, float grow, float radius) {
    float ratio = 1.0 / max(dot(d, d), 1e-30);
    float product = -dot(o, d) * ratio;
    vec3 q = o + product * d;
    float d_2 = max(radius + grow, 0.0);
    float root = sqrt(max(d_2 * d_2 - dot(q, q), 0.0) * ratio);
    float d_3 = product - root;
    float sum = product + root;
    return vec2(d_3, d_3 < sum ? sum : -1e9);
}

// A ball around the origin.
float sphere(vec3 p, float radius) {
    return length(p) - radius;
}

// A ball around the origin.
vec4 sphere_surface(vec3 p, float radius) {
    float len = length(p);
    return vec4(p / max(len, 1e-30), len - radius);
}

// place, size: 16 rows a cluster, the last one padded
const vec4 sphere_table[64] = vec4[](
    vec4(-0.9868428, -0.12069706, -0.040218942, 0.004023906),  // test.sdf:1:31
    vec4(-0.9466038, -0.080458, 2.011953e-5, 0.004064145),  // test.sdf:1:31
    vec4(-0.90636474, -0.040218942, 0.04025918, 0.004104384),  // test.sdf:1:31
    vec4(-0.86612564, 2.011953e-5, -0.040218942, 0.0041446234),  // test.sdf:1:31
    vec4(-0.8258866, 0.04025918, 2.011953e-5, 0.004184862),  // test.sdf:1:31
    vec4(-0.7856475, 0.08049824, 0.04025918, 0.0042251013),  // test.sdf:1:31
    vec4(-0.7454085, 0.1207373, -0.040218942, 0.0042653405),  // test.sdf:1:31
    vec4(-0.70516944, -0.12069706, 2.011953e-5, 0.0043055792),  // test.sdf:1:31
    vec4(-0.66493034, -0.080458, 0.04025918, 0.0043458184),  // test.sdf:1:31
    vec4(-0.6246913, -0.040218942, -0.040218942, 0.0043860576),  // test.sdf:1:31
    vec4(-0.5844522, 2.011953e-5, 2.011953e-5, 0.004426297),  // test.sdf:1:31
    vec4(-0.5442132, 0.04025918, 0.04025918, 0.0044665355),  // test.sdf:1:31
    vec4(-0.50397414, 0.08049824, -0.040218942, 0.0045067747),  // test.sdf:1:31
    vec4(-0.46373504, 0.1207373, 2.011953e-5, 0.004547014),  // test.sdf:1:31
    vec4(-0.42349598, -0.12069706, 0.04025918, 0.004587253),  // test.sdf:1:31
    vec4(-0.38325694, -0.080458, -0.040218942, 0.004627492),  // test.sdf:1:31
    vec4(-0.34301788, -0.040218942, 2.011953e-5, 0.004667731),  // test.sdf:1:31
    vec4(-0.3027788, 2.011953e-5, 0.04025918, 0.00470797),  // test.sdf:1:31
    vec4(-0.26253974, 0.04025918, -0.040218942, 0.004748209),  // test.sdf:1:31
    vec4(-0.2223007, 0.08049824, 2.011953e-5, 0.004788448),  // test.sdf:1:31
    vec4(-0.18206163, 0.1207373, 0.04025918, 0.0048286873),  // test.sdf:1:31
    vec4(-0.14182256, -0.12069706, -0.040218942, 0.0048689265),  // test.sdf:1:31
    vec4(-0.10158351, -0.080458, 2.011953e-5, 0.004909165),  // test.sdf:1:31
    vec4(-0.06134445, -0.040218942, 0.04025918, 0.0049494044),  // test.sdf:1:31
    vec4(-0.021105386, 2.011953e-5, -0.040218942, 0.0049896436),  // test.sdf:1:31
    vec4(0.019133674, 0.04025918, 2.011953e-5, 0.0050298823),  // test.sdf:1:31
    vec4(0.059372734, 0.08049824, 0.04025918, 0.0050701215),  // test.sdf:1:31
    vec4(0.0996118, 0.1207373, -0.040218942, 0.0051103607),  // test.sdf:1:31
    vec4(0.13985085, -0.12069706, 2.011953e-5, 0.0051506),  // test.sdf:1:31
    vec4(0.18008992, -0.080458, 0.04025918, 0.0051908386),  // test.sdf:1:31
    vec4(0.22032897, -0.040218942, -0.040218942, 0.005231078),  // test.sdf:1:31
    vec4(0.26056802, 2.011953e-5, 2.011953e-5, 0.005271317),  // test.sdf:1:31
    vec4(0.3008071, 0.04025918, 0.04025918, 0.005311556),  // test.sdf:1:31
    vec4(0.34104615, 0.08049824, -0.040218942, 0.005351795),  // test.sdf:1:31
    vec4(0.38128522, 0.1207373, 2.011953e-5, 0.005392034),  // test.sdf:1:31
    vec4(0.4215243, -0.12069706, 0.04025918, 0.0054322733),  // test.sdf:1:31
    vec4(0.46176332, -0.080458, -0.040218942, 0.005472512),  // test.sdf:1:31
    vec4(0.5020024, -0.040218942, 2.011953e-5, 0.005512751),  // test.sdf:1:31
    vec4(0.54224145, 2.011953e-5, 0.04025918, 0.0055529904),  // test.sdf:1:31
    vec4(0.5824805, 0.04025918, -0.040218942, 0.0055932296),  // test.sdf:1:31
    vec4(0.6227196, 0.08049824, 2.011953e-5, 0.0056334683),  // test.sdf:1:31
    vec4(0.6629586, 0.1207373, 0.04025918, 0.0056737075),  // test.sdf:1:31
    vec4(0.7031977, -0.12069706, -0.040218942, 0.0057139467),  // test.sdf:1:31
    vec4(0.74343675, -0.080458, 2.011953e-5, 0.005754186),  // test.sdf:1:31
    vec4(0.7836758, -0.040218942, 0.04025918, 0.0057944246),  // test.sdf:1:31
    vec4(0.8239149, 2.011953e-5, -0.040218942, 0.0058346638),  // test.sdf:1:31
    vec4(0.8641539, 0.04025918, 2.011953e-5, 0.005874903),  // test.sdf:1:31
    vec4(0.904393, 0.08049824, 0.04025918, 0.0059151417),  // test.sdf:1:31
    vec4(0.94463205, 0.1207373, -0.040218942, 0.005955381),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562),  // test.sdf:1:31
    vec4(0.98487115, -0.12069706, 2.011953e-5, 0.00599562)  // test.sdf:1:31
);

// the clusters' boxes: centre, half size
const vec4 sphere_boxes[8] = vec4[](
    vec4(-0.6847481, 1.3877788e-17, 0.0, 0.0),
    vec4(0.30612266, 0.12528831, 0.04485043, 0.0),
    vec4(-0.040923126, 1.3877788e-17, -3.469447e-18, 0.0),
    vec4(0.30676648, 0.12585166, 0.045454018, 0.0),
    vec4(0.6029018, 1.3877788e-17, 6.035859e-5, 0.0),
    vec4(0.3074103, 0.12641501, 0.04611796, 0.0),
    vec4(0.9647717, 1.3877788e-17, -0.02007929, 0.0),
    vec4(0.02609903, 0.12669668, 0.02609903, 0.0)
);

float map(vec3 p, float limit) {
    float d2 = limit;
    int sphere_table_group = 0;
    do {
        int sphere_table_row = 16 * sphere_table_group;
        int sphere_table_row_end = sphere_table_row + (box_distance(p - sphere_boxes[2 * sphere_table_group].xyz, sphere_boxes[2 * sphere_table_group + 1].xyz) < d2 ? 16 : 1);
        do {
            {
                vec4 sphere_table_0 = sphere_table[sphere_table_row];
                d2 = min(d2, sphere(p - sphere_table_0.xyz, sphere_table_0.w));
            }
            sphere_table_row += 1;
        } while (sphere_table_row < sphere_table_row_end);
    } while (++sphere_table_group < 4);
    return d2;
}

// the nearest sphere that the ray has met: where it is, what it measures, its material
vec3 sphere_at = vec3(FAR);
float sphere_radius = float(1.0);
float sphere_look = 0.0;
void meet_sphere(vec3 o, vec3 d, float start, inout float first, vec3 at, float sphere_radius_here, float look) {
    float t = enter(sphere_ray(o - at, d, GROW, sphere_radius_here), start);
    if (t < first) { first = t; sphere_at = at; sphere_radius = sphere_radius_here; sphere_look = look; }
}

// the first hit of what is solved in closed form
float events(vec3 o, vec3 d, float start) {
    float first = FAR;
    int sphere_table_group = 0;
    do {
        int sphere_table_row = 16 * sphere_table_group;
        int sphere_table_row_end = sphere_table_row + (enter(box_interval(o - sphere_boxes[2 * sphere_table_group].xyz, d, sphere_boxes[2 * sphere_table_group + 1].xyz), start) < first ? 16 : 1);
        do {
            {
                vec4 sphere_table_0 = sphere_table[sphere_table_row];
                meet_sphere(o, d, start, first, sphere_table_0.xyz, sphere_table_0.w, 0.0);
            }
            sphere_table_row += 1;
        } while (sphere_table_row < sphere_table_row_end);
    } while (++sphere_table_group < 4);
    return first;
}

// requires: events or march (generated)
// provides: trace, the first hit at or after `start` and before `limit`, or FAR
float trace(vec3 o, vec3 d, float start, float limit) {
    float first = events(o, d, start);
    return first < limit ? first : FAR;
}

Surface surface(vec3 p, vec3 d, float fine) {
    vec4 field_sphere_at = sphere_surface(p - sphere_at, sphere_radius);
    return unpainted_material(field_sphere_at);
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
        distances = vec4(distances.yzw, map(p + left.x * normal, left.x));
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
