    // at a point without a gradient (a cone's tip, a medial axis) the surface faces the eye
    s.field.xyz = dot(s.field.xyz, s.field.xyz) > 1e-12 ? s.field.xyz : -d;
    // one Newton step to the surface itself, off the skin that closes cracks and off the tolerance of marching
    float slope = dot(s.field.xyz, d);
    float correction = slope < -0.05 * length(s.field.xyz) ? clamp(s.field.w / slope, -4.0 * tolerance(t), 4.0 * tolerance(t)) : 0.0;
    t -= hit ? correction : 0.0;
    p = o + t * d;
