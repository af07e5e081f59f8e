const vec3 EYE = {{ eye }};  // in the scene's own coordinates: (p - centre) / radius
const vec3 TARGET = {{ target }};
const vec3 VERTICAL = {{ vertical }};
const float HALF_VIEW = {{ half_view }};  // {{ "half the picture's height" if parallel else "the tangent of half the angle of view" }}

vec2 pixel_centre;
vec2 cone;

// the eye's arm, turned by the mouse: around the vertical, and up and down
vec3 turned(vec3 arm) {
    if (iMouse.x + iMouse.y < 1.0) return arm;
    vec2 turn = (iMouse.xy / iResolution.xy - 0.5) * vec2(-6.2831853, -3.1415927);
    float size = length(arm), height = dot(arm, VERTICAL);
    vec3 level = normalize(arm - height * VERTICAL + 1e-6 * VERTICAL.yzx);
    level = cos(turn.x) * level + sin(turn.x) * cross(VERTICAL, level);
    float above = clamp(asin(clamp(height / size, -1.0, 1.0)) + turn.y, -1.55, 1.55);
    return size * (cos(above) * level + sin(above) * VERTICAL);
}

// the ray of this pixel
void camera_ray(out vec3 o, out vec3 d) {
    vec3 arm = turned(EYE - TARGET), ahead = -normalize(arm), right = cross(ahead, VERTICAL);
    right = normalize(dot(right, right) > 1e-12 ? right : cross(ahead, VERTICAL.yzx));
    vec2 at = (2.0 * pixel_centre - iResolution.xy) / iResolution.y;
    vec3 across = HALF_VIEW * (at.x * right + at.y * cross(right, ahead));
{% if parallel %}
    o = TARGET + arm + across;
    d = ahead;
    cone = vec2(HALF_VIEW / iResolution.y, 0.0);
{% else %}
    o = TARGET + arm;
    d = normalize(ahead + across);
    cone = vec2(0.0, HALF_VIEW / iResolution.y);
{% endif %}
}
