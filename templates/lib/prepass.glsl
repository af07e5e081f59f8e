uniform sampler2D tile_starts;  // how far from the eye every tile of pixels is proven empty
float cleared = -FAR;  // the same for the ray at hand, in its own parameter

void look_up_tile() { cleared = texelFetch(tile_starts, ivec2(gl_FragCoord.xy) / {{ tile }}, 0).x - travelled; }
