"""Light on surfaces, written once as expressions: GLSL and float64 come from the same formula."""
