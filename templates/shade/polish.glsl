// at a point without a gradient (a cone's tip, a medial axis) the surface faces the eye
s.field.xyz = dot(s.field.xyz, s.field.xyz) > 1e-28 ? s.field.xyz : -d;
// one Newton step to the surface itself, off the skin that closes cracks and off the tolerance of marching
float steepness = length(s.field.xyz), slope = dot(s.field.xyz, d);
float most = 4.0 * tolerance(t) / clamp(steepness, 0.05, 1.0);
float correction = slope < -0.05 * steepness ? clamp(s.field.w / slope, -most, most) : 0.0;
t = hit ? max(t - correction, -travelled) : t;  // never behind the eye
p = o + t * d;
