// How near counts as there, at parameter t of the ray at hand. What converges fast is asked for all that float32 has;
// the rest for a small part of a pixel.
float rounding(float t) { return {{ smallest }} * max(1.0, abs(t)); }
float tolerance(float t) { return max(rounding(t), {{ fine }} * (cone.x + cone.y * (travelled + t))); }
