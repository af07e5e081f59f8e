    // one Newton step to the surface itself, off the skin that closes cracks and off the tolerance of marching
    float slope = dot(s.field.xyz, d);
    float correction = slope < -0.05 * length(s.field.xyz) ? clamp(s.field.w / slope, -4.0 * tolerance(t), 4.0 * tolerance(t)) : 0.0;
    t -= hit ? correction : 0.0;
    p = o + t * d;
