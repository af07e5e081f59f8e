// How near counts as there, at parameter t of the ray at hand: a small part of a pixel, and never below rounding.
float tolerance(float t) { return max({{ smallest }}, {{ fine }} * (cone.x + cone.y * (travelled + t))); }
